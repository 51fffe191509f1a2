"""Principal-ordinates propagation: multiple anisotropic scattering in clouds (Elek2014).

Each medium has a grid of its own. What a frame computes on it, and what flows between the parts:

    lights, environment -> light/       ordinates; which share of each reaches every cell
    maps of surfaces    -> virtual/     virtual point lights, which are ordinates, too
    other media         -> exchange/    what they scatter, as ordinates of inter-medium irradiance
                               |
             delta/ (default)  |  grids/ (schemes split and paper)
             beams, diffusion  |  propagation from cell to cell
                               |
    indirect light of a lattice -> emission: radiance that cells scatter towards the eye -> marching

settings       what a user can choose
medium/        the grid of a medium, its density, and the coefficients of all media in its cells
light/         ordinates of lights and sky, the density before each cell, shadows of surfaces
virtual/       virtual point lights of what surfaces reflect
exchange/      light that one medium scatters into another
delta/         the scheme delta-beam: forward-scaled beams and one diffusion solve
grids/         the schemes split and paper: light propagates in a grid per ordinate
indirect       indirect light of surfaces, from the lattice that another solver filled
solver         one medium, top to bottom; transport: what a scheme is to it; schemes: which it is;
               several_media: in turn
furnace        the white furnace, which conserves power
media          the solver of a technique: all media of a scene, as sources for marching
delta_scaling  media whose phase function is sharper than the ordinates resolve
"""
