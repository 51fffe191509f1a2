"""Figures and tables of the papers, drawn by this package: an image and a JSON of numbers each.

registry   every figure by name          gallery   one page of all
panels     renderings joined             slices, polar, truths   what several figures draw
clpv_* Kaplanyan2010     lpvms_* Billeter2012     pop_* Elek2014
"""
