"""A closed mesh as a density grid: the share of every voxel that lies inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_SAMPLES = 3  # per voxel along each axis


def solid_voxels(
    positions: F64, triangles: I64, low: F64, high: F64, count: tuple[int, int, int]
) -> F64:
    """(z, y, x), 0..1: what of each of `count` = (x, y, z) voxels of low..high lies inside.

    `positions` (V, 3), `triangles` (T, 3). Columns of samples along x cross the mesh; where more
    faces were entered than left, it is solid (winding number above 0 in size), so meshes that
    intersect themselves are their union. An open mesh leaves streaks.
    """
    # The mesh in samples of the grid, and where lines along x cross it.
    fine = np.array(count) * _SAMPLES
    unit = (positions - low) / (high - low) * fine
    crossing, column, sign = _crossings(unit[triangles], (int(fine[1]), int(fine[2])))
    x = np.clip(np.ceil(crossing - 0.5).astype(np.int64), 0, int(fine[0]))
    # A crossing counts from its place on along the column: running sums are winding numbers.
    steps = np.zeros((int(fine[2]) * int(fine[1]), int(fine[0]) + 1), np.int8)
    np.add.at(steps, (column, x), sign.astype(np.int8))
    inside = np.cumsum(steps[:, :-1], axis=1, dtype=np.int8) != 0

    # Shares of the samples in each voxel.
    nx, ny, nz = count
    parts = inside.reshape(nz, _SAMPLES, ny, _SAMPLES, nx, _SAMPLES)
    return np.asarray(parts.mean(axis=(1, 3, 5)))


def soft_rim(inside: F64) -> F64:
    """The same voxels, each averaged with its neighbours by a tent.

    Between voxels a density is linear. With a rim of shares of voxels alone a dense medium ends
    where the last voxel with any share does, in steps of whole voxels: its outline has teeth. A rim
    three voxels wide has none.
    """
    # A tent of three voxels along one axis after the other.
    for axis in range(3):
        padded = np.moveaxis(np.pad(inside, [(int(i == axis),) * 2 for i in range(3)]), axis, 0)
        mean = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
        inside = np.moveaxis(mean, 0, axis)
    return np.ascontiguousarray(inside)


def _crossings(corners: F64, size: tuple[int, int]) -> tuple[F64, I64, F64]:
    """(x, column, sign) where lines along x cross triangles (T, 3, 3); `size` in (y, z)."""
    # Lines whose place may lie in each triangle's box.
    y, z = corners[..., 1], corners[..., 2]
    low_y, high_y = _range(y, size[0])
    low_z, high_z = _range(z, size[1])
    wide, tall = np.maximum(high_y - low_y, 0), np.maximum(high_z - low_z, 0)
    # Each triangle with each line through its box, in one flat list.
    held = wide * tall
    triangle = np.repeat(np.arange(len(corners)), held)
    place = np.arange(held.sum()) - np.repeat(np.cumsum(held) - held, held)
    row, line = np.divmod(place, np.maximum(wide[triangle], 1))
    j, k = low_y[triangle] + line, low_z[triangle] + row
    a, b, c = (corners[triangle, i] for i in range(3))
    # A hair off the samples' middle, so that no line meets an edge of a regular mesh.
    py, pz = j + 0.5 + 1.3e-4, k + 0.5 + 2.9e-4
    # Barycentric coordinates in the plane across the lines, and x from them.
    area = _cross(b - a, c - a)
    u = _cross(np.stack([a[:, 0], py, pz], 1) - a, c - a) / np.where(area == 0.0, 1.0, area)
    v = _cross(b - a, np.stack([a[:, 0], py, pz], 1) - a) / np.where(area == 0.0, 1.0, area)
    hit = (area != 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
    x = a[:, 0] + u * (b - a)[:, 0] + v * (c - a)[:, 0]
    return x[hit], (k * size[0] + j)[hit], np.sign(area)[hit]


def _cross(a: F64, b: F64) -> F64:
    """Of the (y, z) parts."""
    return np.asarray(a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1])


def _range(values: F64, size: int) -> tuple[I64, I64]:
    """Samples first..last + 1 whose middle may lie among (T, 3) values."""
    low = np.clip(np.floor(values.min(axis=1) - 0.6), 0, size).astype(np.int64)
    high = np.clip(np.ceil(values.max(axis=1) + 0.6), 0, size).astype(np.int64)
    return low, high
