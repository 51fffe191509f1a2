"""Multiple scattering on a lattice of 26 neighbours (Billeter2012).

hop_wgsl       the unrolled gather, generated         coefficients   media -> numbers of a step
propagate      one step, homogeneous or per cell      walls          openness of all 26 hops
levels         coarser lattices for slow light        inject_single  first-scattered light -> cells
inject_reflected   light that surfaces reflect        emission       track -> textures
solver         all of it, top to bottom

A lattice is a storage buffer of vec4f (A, Bx, By, Bz) laid out [channel][z][y][x], in power units:
(A, B) = 4pi (a, b) of the intensity a + b.w, so A is the cell's power, W.
"""
