"""Cells that surfaces part: NumPy twin of `lattice/parted.wgsl`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Flags = NDArray[np.bool_]

REACH = 3
"""Cells that a way around may lead to each side of a face's two cells."""


def parted(crossed: Flags) -> Flags:
    """(3, Z, Y, X): the cells that are parted from the next along x, y, z.

    `crossed`, of that shape: where a surface lies between the middles of the two. They are parted
    where no way leads around it, from middle to middle of the cells within REACH of them. What
    leaves the lattice does not come back.
    """
    found = np.zeros_like(crossed)
    padded = np.pad(crossed, ((0, 0), *[(REACH, REACH + 1)] * 3), constant_values=True)
    for axis in range(3):
        # Around each crossed face the cells near it; arrays are (z, y, x).
        size = np.full(3, 2 * REACH + 1)
        size[2 - axis] += 1
        for z, y, x in np.argwhere(crossed[axis]):
            near = padded[:, z : z + size[0], y : y + size[1], x : x + size[2]]
            goal = np.full(3, REACH)
            goal[2 - axis] += 1
            found[axis, z, y, x] = not _reached(near)[tuple(goal)]
    return found


def _reached(crossed: Flags) -> Flags:
    """The cells to which ways lead from the one REACH from the first corner, past no face."""
    reached = np.zeros(crossed.shape[1:], bool)
    reached[(REACH,) * 3] = True
    count = 0
    while count < (count := int(reached.sum())):
        for axis in range(3):
            # From each cell to the next along the axis, and back.
            along = np.moveaxis(reached, 2 - axis, 0)
            is_open = ~np.moveaxis(crossed[axis], 2 - axis, 0)
            along[1:] |= along[:-1] & is_open[:-1]
            along[:-1] |= along[1:] & is_open[:-1]
    return reached
