"""Principal-ordinates propagation: multiple anisotropic scattering in clouds (Elek2014).

placement    where a medium's own grid is        density    its cells, from a volume's voxels
ordinates    light as a few directions           paths      how much air lies before each cell
importance   what the camera sees of the sky
deposit      light that leaves the beams         diffuse    where it spreads: one linear solve
near_light   what both miss close to lamps       emission   in-scattered radiance to the eye
schemes      beams, or hops from cell to cell     hop_grids  a grid per ordinate and lamp
propagate    hops through all grids at once      hop_merge  back to the medium's cells
solver       one medium, top to bottom           media      all media of a scene, marched
mixture      media in one another's grids        given      what others scatter into one
together     several media in one frame
"""
