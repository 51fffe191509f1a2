"""Inter-medium irradiance: light that one medium scatters into the box of another.

other medium, solved -> irradiance: its blocks as sources -> ordinates of the receiving medium
blockers of the lattice -> visibility: share of each block that a cell sees past surfaces
"""
