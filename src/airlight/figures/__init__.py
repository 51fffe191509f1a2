"""The papers' figures and tables, ours: each an image and the JSON of its numbers.

registry   every figure by name       panels   rendering panels and joining them
slices     a solved lattice, cut open, as an image
clpv_*     Kaplanyan2010
"""
