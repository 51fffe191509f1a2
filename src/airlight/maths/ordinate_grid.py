"""Grids turned along an ordinate: where they lie, which medium is in them, how they are read back.

Elek2014 section 4: one axis of the grid runs along the light, the grid spans the medium. Cells are
cubes; a grid's third axis is the light's direction of travel. Arrays are (z, y, x) of that frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64, I64
from .sampling import orthonormal_frame
from .voxels import trilinear

ROLLS = 16  # turns about the light that are tried for the smallest grid
_TIGHT = 1.01  # growth of a cell until its grid has few enough
_SUBCELLS = (-0.25, 0.25)  # where a cell's density is sampled along each axis, in cells


@dataclass(frozen=True, eq=False)
class OrdinateGrids:
    """One grid per ordinate in a medium's box: all arrays have N rows.

    `axes` (N, 3, 3): unit x, y and z (the light's travel) in the medium's frame; `corner` (N, 3),
    m; `cell` (N,), m; `count` (N, 3).
    """

    axes: F64
    corner: F64
    cell: F64
    count: I64

    def centres(self, n: int) -> F64:
        """Cell centres (z, y, x, 3), m in the medium's frame, of grid n."""
        x, y, z = (np.arange(k) + 0.5 for k in self.count[n])
        zz, yy, xx = np.meshgrid(z, y, x, indexing="ij")
        local = self.cell[n] * np.stack([xx, yy, zz], axis=-1)
        return np.asarray(self.corner[n] + local @ self.axes[n])

    def places(self, n: int, points: F64) -> F64:
        """Points (..., 3), m, of the medium's frame in cells of grid n from its corner."""
        return np.asarray((points - self.corner[n]) @ self.axes[n].T / self.cell[n])


def ordinate_grids(extent: ArrayLike, directions: ArrayLike, cells: int) -> OrdinateGrids:
    """Grids of at most `cells` cubes each that span a box (3,), m, along directions (N, 3)."""
    size = np.asarray(extent, dtype=np.float64)
    d = np.asarray(directions, dtype=np.float64).reshape(-1, 3)
    x, y = (np.asarray(v, dtype=np.float64) for v in orthonormal_frame(d))
    # Rolled about its direction, a grid's cross section is smallest where it lies along the box.
    angle = np.arange(ROLLS) * (0.5 * np.pi / ROLLS)
    c, s = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    tried_x, tried_y = c * x + s * y, c * y - s * x
    area = (np.abs(tried_x) @ size) * (np.abs(tried_y) @ size)
    best = np.argmin(np.round(area / area.min(axis=0).clip(1e-30), 9), axis=0)
    row = np.arange(len(d))
    axes = np.stack([tried_x[best, row], tried_y[best, row], d], axis=1)
    # Cubes as large as the number of cells allows; rounding up may take a few too many.
    spanned = np.abs(axes) @ size
    cell = np.cbrt(spanned.prod(axis=1) / cells)
    count = _count(spanned, cell)
    while np.any(too_many := count.prod(axis=1) > cells):
        cell = np.where(too_many, _TIGHT * cell, cell)
        count = _count(spanned, cell)
    # The middle of the grid is the middle of the box.
    corner = 0.5 * size - np.einsum("ni,nij->nj", 0.5 * count * cell[:, None], axes)
    return OrdinateGrids(axes, corner, cell, count)


def _count(spanned: F64, cell: F64) -> I64:
    return np.maximum(np.ceil(spanned / cell[:, None] - 1e-6), 1.0).astype(np.int64)


def grid_density(grids: OrdinateGrids, n: int, fine: F64, extent: F64) -> F64:
    """Mean density (z, y, x) in the cells of grid n: eight samples each, 0 outside the box."""
    # Eight samples a cell, none outside of the box.
    centres = grids.centres(n)
    total: F64 = np.zeros(centres.shape[:-1])
    scale = np.array(fine.shape[::-1]) / extent
    for k in np.ndindex(2, 2, 2):
        offset = grids.cell[n] * np.array([_SUBCELLS[i] for i in k]) @ grids.axes[n]
        p = centres + offset
        inside = np.all((p >= 0.0) & (p <= extent), axis=-1)
        total = total + np.where(inside, trilinear(fine, p * scale), 0.0)
    return total / 8.0


def read_back(place: F64, density: F64, values: F64) -> F64:
    """Values (z, y, x, k) of a grid at places (..., 3) in it, trilinear, weighted by density.

    Empty cells have no say: what is asked for belongs to the medium. 0 where all are empty.
    """
    # A weighted mean whose weights are the densities between the same cells.
    weight = trilinear(density, place)
    safe = np.maximum(weight, 1e-12)
    weighted = [trilinear(values[..., k] * density, place) / safe for k in range(values.shape[-1])]
    return np.where(weight[..., None] > 1e-12, np.stack(weighted, axis=-1), 0.0)
