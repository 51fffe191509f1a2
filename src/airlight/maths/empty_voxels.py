"""How far the empty voxels of a density grid are from those that hold something.

Distances are the largest of those along the axes, in voxels. The density between voxels is
trilinear, so a voxel that holds something reaches one voxel far.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

RADII = (1, 2, 4, 8, 16)
"""Voxels; whether anything is within them is what is known of an empty voxel."""
REACH = 2.25
"""Voxels less than the interpolated distance are free around a point: one because interpolation
averages voxels up to one away, one that the matter reaches, the rest for filters of 8 bits."""


def empty_distances(density: NDArray[Any]) -> NDArray[np.float16]:
    """(z, y, x): no voxel that is not 0 is nearer than this; 0 in such a voxel, at most 17."""
    # One mask, widened from radius to radius.
    near = density != 0.0
    distances = np.where(near, np.float16(0.0), np.float16(1.0))
    known = 0
    # Full voxels are widened: what a radius does not reach is farther than it, by 1 at least.
    for radius in RADII:
        near = _widened(near, radius - known)
        known = radius
        distances[~near] = radius + 1
    return distances


def free_voxels(interpolated: NDArray[Any]) -> NDArray[Any]:
    """How far all density is 0 around a point, voxels along each axis."""
    return np.maximum(interpolated - REACH, 0.0)


def _widened(near: NDArray[np.bool_], by: int) -> NDArray[np.bool_]:
    """What is within `by` voxels of `near`, along all axes; `near` is at least half as wide."""
    # Both ways along one axis at a time: a box of the radius.
    for axis in range(3):
        wide, along = near.copy(), np.moveaxis(near, axis, 0)
        wider = np.moveaxis(wide, axis, 0)
        wider[by:] |= along[:-by]
        wider[:-by] |= along[by:]
        near = wide
    return near
