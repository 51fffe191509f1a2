"""Principal-ordinates propagation: multiple anisotropic scattering in clouds (Elek2014).

placement    where a medium's own grid is        density    its cells, from a volume's voxels
ordinates    light as a few directions           paths      how much air lies before each cell
deposit      light that leaves the beams         diffuse    where it spreads: one linear solve
emission     in-scattered radiance to the eye    solver     the technique, top to bottom
"""
