"""Lights with extent: what they are, what stands for them, and their direct light on surfaces.

sources     a scene's glowing meshes and area lights, one side each
pieces      their small triangles, as they stand
strata      pieces in groups of equal power
shapes      the polygon or sphere that a group of pieces is, for the analytic part
emitters    groups with shapes and samples, for every frame; the scene as lattices and media see it
table       emitters and samples on the device, and the views of the samples' shadow maps
lighting    a pass: analytic irradiance and GGX times the share of samples that a pixel sees
"""
