"""Lights with extent: area lights and emissive meshes, and their direct light on surfaces.

glowing   media that give off light, as samples alone, of emissive_blocks of their voxels
sources   a scene's area lights and emissive meshes, one side each; touching: those
               that files cut
-> pieces, threads   small triangles, of smooth parts; tubes of few sides are one
-> grouping, strata, stretches   groups of equal power, a sample for each stratum; bent ones in
               straight stretches
-> shapes, emitters   a polygon or sphere for each group; samples with shadow maps (emitter),
               segments where a part is long and thin, at places in or on it
-> sizes  what a part is as large as, to media near it
-> table  emitters and samples on the device
-> outlines, coverage   polygons in stills, by the part of each pixel that they cover
-> lighting  analytic irradiance and GGX times the visibility of samples
"""
