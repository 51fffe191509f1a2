"""Lattices: where cells are, what is injected into them, what blocks, how light is read.

   placement, nested    cells in the world; finer lattices ahead of the camera
   facing, fitting      the axes along which cells are laid: those of the scene's walls; cells that
                        end at those
   gaps                 how far apart surfaces are, and how many lattices that asks for
   bodies, rooms        closed bodies, which side of them blocks, which hold the eye or a light
   surfels -> blockers  samples of all surfaces -> visibility and reflectance of cell faces, and the
                        oblique plane that a cell is near
   inject, lobes, point_lights      virtual point lights (lobes) -> fixed-point sums -> cells
   skylight             the sky's direct light: an ambient cube per cell
   lookup -> irradiance cells -> filtered textures -> what surfaces read
   view_surfels         surfels from the views of camera and lights instead
   lattices             all of this for one scene; the solvers (lpv, scatter) propagate
   table                the lattices as shaders loop over them

A lattice is a storage buffer of vec4f (a, bx, by, bz) laid out [channel][z][y][x]: intensity
I(w) = a + b.w in W sr^-1 as a function of travel direction w. A cell's power is 4 pi a.
"""
