"""The papers' figures and tables, ours: each a picture and the JSON of its numbers.

registry   every figure by name       panels   rendering panels and joining them
slices     a solved lattice, cut open, as a picture
clpv_*     Kaplanyan2010
"""
