"""Single scattering with sharp volumetric shadows, and all that air does to a picture.

bounds     the nearest and farthest depth of every square of shadow-map texels
shafts     lit runs of eye rays through shadow maps, each integrated at once, or in density grids
           step by step
facets     shadow maps as quad-trees of planar facets, and the triangles that bound their shadows
volumes    the paper's way: those triangles drawn and added up
jitter     the cheap way: jittered steps
sky_air    the environment's light in cells: scattered once, and on surfaces through air
blur       takes the jitter's pattern out again
air_light  the facade: single scattering, marched sources, transmittance
"""
