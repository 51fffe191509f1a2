"""Multiple scattering on a lattice of 26 neighbours (Billeter2012).

    reflective shadow maps     lights, sky            media, walls
            |                      |                       |
      inject_maps     inject_single, inject_border    cell_medium, hop_visibility, coefficients
            |                      |                       |
            +---- W per cell ------+                       |
                      |                                    |
                   levels: steps (propagate), multigrid cycles (level_passes, line_search,
                      |            schedule), global power_rescaling
                      |
           sum of states Q, its track T Q
                      |                         forward: light deflected once, light by light
                      |                                    |
        surface_light: irradiance of surfaces     emission: mean radiance in media
                      |                                    |
                  fields.irradiance              fields.scattered, fields.reflected

`solver` runs all of it, `settings` says what it can be told, `reduced` makes isotropic media of
those that scatter forwards, `map_blockers` takes walls from six shadow maps. `propagate` has the
stencil.

A lattice is a storage buffer of vec4f (A, Bx, By, Bz) laid out [channel][z][y][x], in power units:
(A, B) = 4pi (a, b) of the intensity a + b.w, so A is the cell's power, W.
"""
