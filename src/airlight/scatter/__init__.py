"""Multiple scattering on nested lattices of 26 neighbours (Billeter2012), the largest first.

    reflective shadow maps, lights, sky           media, walls
                   |                                   |
       injection: inject_single, inject_rays,   cells: reduced_media, cell_medium,
                  inject_border, forward;              reflectance, hop_visibility
                  inject_outer of a larger lattice
                   |                                   |
              W per cell                         coefficients of a hop
                   |                                   |
                   +----------------+------------------+
                                    |
               state_sum: steps (propagate, schedule) with corrections by regions
                          (region_passes), global power_rescaling
                                    |
                       sum of states Q, its track T Q
                         |                        |
        surface_light: irradiance       emission: mean radiance in media
                         |                        |   and beside it forward's light, light by light
                fields.irradiance       fields.scattered, fields.reflected

`solver` runs all of it for each of `cascades`. `entering_light` is what these share of lights, and
`cell_lights` what their cells gather, of the sky from a `sky_table`; `settings` says what can be
told, `map_blockers` takes walls from six shadow maps. `propagate` has the stencil.
`forward_textures` and `light_in_air` are what marching and the final gather read; `surface_beams`
what surfaces read of `forward`, `forward_beams` the same of all media of a scene, in the cells that
`near_surfaces` finds.

A lattice is a storage buffer of vec4f (A, Bx, By, Bz) laid out [channel][z][y][x], in power units:
(A, B) = 4pi (a, b) of the intensity a + b.w, so A is the cell's power, W.
"""
