"""The light that reaches the cells of a medium, as ordinates (Elek2014 sections 4.1 and 5.1).

illumination: the light of a frame, and its eye
lights, environment -> ordinates (importance: directed to what the camera sees)
ordinates, density  -> paths: density before every cell, an entry per ordinate and cell
shadow maps         -> visibility of each ordinate past surfaces
meshes              -> walls between cells, found by rays
environment map     -> sky_correction: exact single scattering of the sky in clear media
-> table: ordinates on the device -> incident: their light in each cell
"""
