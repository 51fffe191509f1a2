"""Multiple scattering on a lattice of 26 neighbours (Billeter2012).

settings         what it can be told                reduced         isotropic media for forward ones
hop_wgsl         the unrolled gather, generated     coefficients    media -> numbers of a step
propagate        one step, homogeneous media        propagate_varied  and media that vary
cell_medium        the air's coefficients per cell    walls           visibility of all 26 hops
propagate_open   the same without walls, faster     map_blockers    walls from six shadow maps
levels           sums of states, coarser lattices   schedule        how many steps on which
correction       how long a coarse correction is
inject_single    first-scattered light -> cells     inject_maps     reflected light; sampled rays
forward          unscattered light of the reduced medium, per light
emission         the track, for marching            surface_light   summed states, for surfaces
solver           all of it, top to bottom

A lattice is a storage buffer of vec4f (A, Bx, By, Bz) laid out [channel][z][y][x], in power units:
(A, B) = 4pi (a, b) of the intensity a + b.w, so A is the cell's power, W.
"""
