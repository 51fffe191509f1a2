"""Figures and tables of the papers, drawn by this package: an image and a JSON of numbers each.

registry          every figure by its name; it draws one and stores its image and numbers
clpv_*            Kaplanyan2010     lpvms_*   Billeter2012     pop_*   Elek2014
imperfect         imperfect shadow maps of virtual lights, in NumPy
preview_to_truth  a still of more and more samples beside a path tracer's

    scenes -> renderings; truths, path traced -> panels, exposed alike, joined on one sheet
    lattices -> slices, cascades, leaks; directions -> polar; numbers -> table
    images and JSON of all figures -> gallery, one page
"""
