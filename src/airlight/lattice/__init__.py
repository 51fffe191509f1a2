"""What the lattice techniques share: where cells are, what is put in them, how light is read.

placement    cells in the world                inject       virtual point lights -> cells
surfels      samples of all surfaces           blockers     surfels -> openness of cell faces
lookup       cells -> filtered textures -> irradiance

A lattice is a storage buffer of vec4f (a, bx, by, bz) laid out [channel][z][y][x]: intensity
I(w) = a + b.w in W sr^-1 as a function of travel direction w. A cell's power is 4 pi a.
"""
