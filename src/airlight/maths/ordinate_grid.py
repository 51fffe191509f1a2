"""Grids aligned with a direction of light, and the optical path that light has behind it there.

A medium fills a box with its lower corner at 0 and its axes x, y, z, metres. Per ordinate (one
direction of distant light) a grid of count^3 cells spans the box, one axis along the light;
a single sweep along that axis stores the density passed so far (Elek2014 section 4.1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]


def trilinear(grid: F64, place: F64) -> F64:
    """Values (...) of a voxel-centred grid (z, y, x) at places (..., 3), voxels from its corner.

    Clamped at the border.
    """
    top = np.array(grid.shape[2::-1]) - 1.0
    at = np.clip(place - 0.5, 0.0, top)
    low = np.minimum(np.floor(at), np.maximum(top - 1.0, 0.0)).astype(np.int64)
    w = at - low
    high = np.minimum(low + 1, top.astype(np.int64))
    total: F64 = np.zeros(place.shape[:-1])
    for corner in range(8):
        upper = [(corner >> axis) & 1 for axis in range(3)]
        i, j, k = (np.where(u, high[..., a], low[..., a]) for a, u in enumerate(upper))
        share = np.prod([w[..., a] if u else 1.0 - w[..., a] for a, u in enumerate(upper)], axis=0)
        total += share * grid[k, j, i]
    return total


def box_averaged(density: ArrayLike, count: tuple[int, int, int]) -> F64:
    """Means of a density grid (z, y, x) over `count` = (x, y, z) cells of its box: (z, y, x).

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


@dataclass(frozen=True, eq=False)
class OrdinateGrid:
    """Cells around the medium's box with the third axis along the light.

    `frame` (3, 3): rows are the grid's axes in the medium's; `low` (3,) m: the corner of cell 0 in
    the grid's axes, from the box's centre; `cell` (3,) m.
    """

    frame: F64
    low: F64
    cell: F64

    @property
    def direction(self) -> F64:
        """Of travel (3,)."""
        return np.asarray(self.frame[2])

    def place(self, points: F64, extent: F64) -> F64:
        """Points (..., 3), m in the medium's box, in cells of this grid."""
        local = (points - 0.5 * extent) @ self.frame.T
        return np.asarray((local - self.low) / self.cell)


def ordinate_frame(direction: ArrayLike) -> F64:
    """Rows (3, 3): two axes across the unit direction of travel, and the direction itself.

    The first lies along the box axis that is most across the light, so that light along an axis
    has an aligned grid.
    """
    d = np.asarray(direction, dtype=np.float64)
    across = np.zeros(3)
    across[int(np.argmin(np.abs(d)))] = 1.0
    u = across - (across @ d) * d
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(d, u), d])


def ordinate_grid(direction: ArrayLike, extent: ArrayLike, count: int) -> OrdinateGrid:
    """The smallest grid of `count`^3 cells around a box of size `extent` (3,), m."""
    frame = ordinate_frame(direction)
    half = np.abs(frame) @ (0.5 * np.asarray(extent, dtype=np.float64))
    return OrdinateGrid(frame, -half, 2.0 * half / count)


def sweep(grid: OrdinateGrid, density: F64, extent: F64, count: int) -> F64:
    """Density passed (count + 1, count, count), m: index [face along d, v, u]; face 0 is entry.

    Each cell's density is the mean of 2^3 samples of `density` (z, y, x), 0 outside the box.
    """
    offsets = np.array([-0.25, 0.25])
    k, j, i = np.meshgrid(*[np.arange(count) + 0.5] * 3, indexing="ij")
    mean: F64 = np.zeros((count,) * 3)
    size = np.array(density.shape[::-1])
    for du in offsets:
        for dv in offsets:
            for dw in offsets:
                place = np.stack([i + du, j + dv, k + dw], axis=-1)
                point = (grid.low + place * grid.cell) @ grid.frame + 0.5 * extent
                unit = point / extent
                inside = np.all((unit > 0.0) & (unit < 1.0), axis=-1)
                mean += inside * trilinear(density, unit * size) / 8.0
    passed: F64 = np.zeros((count + 1, count, count))
    np.cumsum(mean * grid.cell[2], axis=0, out=passed[1:])
    return passed


def passed_at(passed: F64, place: F64) -> F64:
    """Density passed (...), m, at places (..., 3) in cells of its grid; clamped outside."""
    # Faces along the light, centres across it: half a cell apart from a voxel-centred grid.
    return trilinear(passed, place + np.array([0.0, 0.0, 0.5]))
