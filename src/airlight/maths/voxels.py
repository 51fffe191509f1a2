"""Density on a regular grid: interpolated, averaged into cells, summed along rays.

Grids are (z, y, x), voxel-centred. A medium fills a box with its lower corner at 0 and its axes
x, y, z, metres.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .medium import ray_box_interval


def trilinear(grid: F64, place: F64) -> F64:
    """Values (...) at places (..., 3), voxels x, y, z from the corner; clamped at the border."""
    top = np.array(grid.shape[2::-1]) - 1.0
    # Values stand at the middle of voxels.
    at = np.clip(place - 0.5, 0.0, top)
    low = np.minimum(np.floor(at), np.maximum(top - 1.0, 0.0)).astype(np.int64)
    w = at - low
    high = np.minimum(low + 1, top.astype(np.int64))
    total: F64 = np.zeros(place.shape[:-1])
    # Eight corners, weighted by nearness along each axis.
    for corner in range(8):
        upper = [(corner >> axis) & 1 for axis in range(3)]
        i, j, k = (np.where(u, high[..., a], low[..., a]) for a, u in enumerate(upper))
        share = np.prod([w[..., a] if u else 1.0 - w[..., a] for a, u in enumerate(upper)], axis=0)
        total += share * grid[k, j, i]
    return total


def box_averaged(density: ArrayLike, count: tuple[int, int, int]) -> F64:
    """Means (z, y, x) of a density grid over `count` = (x, y, z) cells of its box.

    Trilinear samples, at least one per voxel and axis, up to 16, evenly spread in a cell.
    """
    grid = np.asarray(density, dtype=np.float64)
    for axis in range(3):
        grid = _averaged_along(grid, axis, count[2 - axis])
    return grid


def _averaged_along(grid: F64, axis: int, cells: int) -> F64:
    """`box_averaged` along one axis; trilinear sampling is separable."""
    voxels = grid.shape[axis]
    samples = samples_per_cell(voxels, cells)
    # Samples within each cell, read linearly between voxels, then averaged.
    unit = (np.arange(cells * samples) + 0.5) / (cells * samples)
    at = np.clip(unit * voxels - 0.5, 0.0, voxels - 1.0)
    low = np.minimum(at.astype(np.int64), max(voxels - 2, 0))
    high = np.minimum(low + 1, voxels - 1)
    shape = [1] * grid.ndim
    shape[axis] = -1
    w = (at - low).reshape(shape)
    fine = (1.0 - w) * np.take(grid, low, axis) + w * np.take(grid, high, axis)
    split = (*grid.shape[:axis], cells, samples, *grid.shape[axis + 1 :])
    return np.asarray(fine.reshape(split).mean(axis=axis + 1))


def samples_per_cell(voxels: int, cells: int) -> int:
    """How many samples along an axis average `voxels` into `cells`."""
    return int(np.clip(-(-voxels // cells), 1, 16))


def density_behind(
    density: F64,
    extent: F64,
    points: F64,
    direction: ArrayLike,
    step_m: float,
    distance_m: ArrayLike = np.inf,
) -> F64:
    """Density passed (...), m, by light of travel `direction` when it reaches `points` (..., 3).

    Directions (3,) or (..., 3), unit. From where the light enters the box (extent (3,), m), or
    from its light `distance_m` before the point, in equal steps of at most `step_m`, each sampled
    in its middle.
    """
    # Back to where the light enters the box or begins.
    back = -np.asarray(direction, dtype=np.float64)
    _, length = ray_box_interval(points, back, np.zeros(3), extent)
    length = np.minimum(np.maximum(length, 0.0), distance_m)
    steps = np.maximum(np.ceil(length / step_m), 1.0)
    dt = length / steps

    # Midpoints of equal steps, in voxels.
    total: F64 = np.zeros(length.shape)
    scale = np.array(density.shape[::-1]) / extent
    # Rays with fewer steps than the longest have ended, and add nothing.
    for k in range(int(steps.max())):
        place = (points + ((k + 0.5) * dt)[..., None] * back) * scale
        total += np.where(k < steps, dt * trilinear(density, place), 0.0)
    return total


def ratio(part: ArrayLike, whole: ArrayLike) -> F64:
    """part / whole of grids (z, y, x, ...) where `whole` is more than 0; elsewhere that of the
    neighbours' sums, and 0 without neighbours.

    Interpolated between a voxel of matter and an empty one, a ratio should stay what the matter's
    is: what is empty says nothing of it.
    """
    a, b = (np.asarray(values, dtype=np.float64) for values in (part, whole))
    a, b = np.broadcast_arrays(a, b)
    is_empty = b <= 0.0
    found = a / np.where(is_empty, 1.0, b)
    if is_empty.any():
        sums = [_of_neighbours(np.where(is_empty, 0.0, values)) for values in (a, b)]
        near = sums[0] / np.where(sums[1] > 0.0, sums[1], 1.0)
        found = np.where(is_empty, near, found)
    return np.asarray(found)


def _of_neighbours(values: F64) -> F64:
    """The sums over 3 x 3 x 3 voxels, with nothing beyond the border."""
    for axis in range(3):
        width = [(int(axis == k),) * 2 for k in range(values.ndim)]
        padded = np.moveaxis(np.pad(values, width), axis, 0)
        values = np.moveaxis(padded[:-2] + padded[1:-1] + padded[2:], 0, axis)
    return values
