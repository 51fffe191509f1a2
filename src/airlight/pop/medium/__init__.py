"""A medium on a grid of its own: what every pass over its cells binds.

volume -> placement: a box of cells -> density: means of voxels in cells
       -> mixture: coefficients of all media in those cells
grid_medium: all of it for one volume; finer_medium: a part of it on a finer grid (nesting: where)
surrounding: what a medium around it, which a lattice solves, leaves of its light
known_walls: where the solvers of volumes know what walls send back
merged_medium: many volumes on one grid (merging: as what medium; kinds: which)
"""
