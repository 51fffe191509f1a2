"""Grids of shells around a point light, their cells on an octahedron (Elek2014 section 6).

A radial grid is a box of cells like any other: x and y on the octahedron's square, which is sewn to
itself along its edges, z the shell. Shells grow by a constant factor, so that cells stay compact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64
from .octahedron import (
    octahedron_cell_centres,
    octahedron_cell_solid_angles,
    octahedron_decode,
    octahedron_encode,
    octahedron_neighbour,
)
from .ordinate_hops import Hops
from .voxels import trilinear


@dataclass(frozen=True)
class RadialGrid:
    """`side`^2 cells a shell (even), `shells` of them out to `radius`, m, around `centre` (3,)."""

    centre: tuple[float, float, float]
    radius: float
    side: int
    shells: int

    @property
    def growth(self) -> float:
        """Outer radius of a shell over that of the one inside it: cells about as deep as wide."""
        return shell_growth(self.side)

    @property
    def edges(self) -> F64:
        """Radii (shells + 1,), m, from 0."""
        # The outermost shell ends at the radius; each one inside is smaller by the growth.
        outer = self.radius * self.growth ** (np.arange(self.shells) - (self.shells - 1.0))
        return np.concatenate([[0.0], outer])

    @property
    def radii(self) -> F64:
        """Middles of the shells (shells,), m."""
        return np.asarray(0.5 * (self.edges[1:] + self.edges[:-1]))

    def centres(self) -> F64:
        """Cell centres (z, y, x, 3), m."""
        away = self.radii[:, None, None, None] * octahedron_cell_centres(self.side)
        return np.asarray(away + np.asarray(self.centre))

    def places(self, points: F64) -> F64:
        """Points (..., 3), m, in cells of the grid: u, v, shell; inside the shells' middles.

        Shells are numbered linearly in the innermost one, by the logarithm outside it.
        """
        # At the light itself any direction will do.
        away = points - np.asarray(self.centre)
        r = np.maximum(np.linalg.norm(away, axis=-1), 1e-9 * self.radius)
        direction = np.where(r[..., None] > 1e-8 * self.radius, away, [0.0, 0.0, 1.0])
        square = (octahedron_encode(direction) + 1.0) * (0.5 * self.side)

        # Shells by the logarithm of the radius, but for the innermost.
        inner = self.edges[1]
        shell = np.where(
            r < inner, r / inner, 1.0 + np.log(np.maximum(r / inner, 1.0)) / np.log(self.growth)
        )
        return np.concatenate([square, shell[..., None]], axis=-1)

    def hops(self, extent: ArrayLike | None = None) -> Hops:
        """How light moves in it; what leaves a box (3,), m, around the medium is lost."""
        n, edges = self.side, self.edges
        omega = octahedron_cell_solid_angles(n)
        # Neighbours on the octahedral map, across its folds too.
        v, u = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
        cell = np.stack([u, v], axis=-1)
        steps = ((-1, 0), (1, 0), (0, -1), (0, 1))
        others = [octahedron_neighbour(cell, np.array(step), n) for step in steps]
        beside = np.stack([o[..., 1] * n + o[..., 0] for o in others])
        other_omega = omega.reshape(-1)[beside]
        # Shells: path r1 - r0, volume omega (r1^3 - r0^3) / 3, section omega r^2.
        path = np.diff(edges)[:, None, None, None]
        middle = self.radii[:, None, None, None]
        cubes = np.diff(edges**3)[:, None, None, None] / 3.0
        around = omega[None, :, :, None]
        return Hops(
            path,
            cubes * around,
            middle**2 * around,
            beside,
            2.0 * other_omega / (omega + other_omega),
            path / np.maximum(middle, path),
            None if extent is None else _inside(_samples(self), extent, n)[..., None],
        )


def shell_growth(side: int) -> float:
    """That of shells of `side`^2 cells."""
    return 1.0 + float(np.sqrt(4.0 * np.pi)) / side


def radial_grid(extent: ArrayLike, centre: ArrayLike, side: int, shells: int) -> RadialGrid:
    """Out to the farthest corner of a box (3,), m; `side` is rounded up to an even number."""
    # The farthest corner is on the other side of the light on every axis.
    size, p = np.asarray(extent, dtype=np.float64), np.asarray(centre, dtype=np.float64)
    radius = float(np.linalg.norm(np.maximum(p, size - p)))
    return RadialGrid((float(p[0]), float(p[1]), float(p[2])), radius, side + side % 2, shells)


def radial_density(grid: RadialGrid, fine: F64, extent: F64) -> F64:
    """Mean density (z, y, x) in a grid's cells: eight samples each, 0 outside the box."""
    # The mean of eight samples, of which those outside the box are empty.
    p = _samples(grid)
    inside = np.all((p >= 0.0) & (p <= extent), axis=-1)
    rho = np.where(inside, trilinear(fine, p * (np.array(fine.shape[::-1]) / extent)), 0.0)
    n = grid.side
    return np.asarray(rho.reshape(grid.shells, 2, n, 2, n, 2).mean(axis=(1, 3, 5)))


def _samples(grid: RadialGrid) -> F64:
    """Points (2z, 2y, 2x, 3), m: eight in each cell."""
    # Two along each axis of a cell, a quarter in from its sides.
    at = (np.arange(grid.side)[:, None] + np.array([0.25, 0.75])).ravel() * (2.0 / grid.side) - 1.0
    u, v = np.meshgrid(at, at)
    direction = octahedron_decode(np.stack([u, v], axis=-1))
    depth = np.diff(grid.edges)[:, None] * np.array([0.25, 0.75]) + grid.edges[:-1, None]
    return np.asarray(depth.reshape(-1, 1, 1, 1) * direction + np.asarray(grid.centre))


def _inside(samples: F64, extent: ArrayLike, side: int) -> NDArray[np.bool_]:
    """Cells (z, y, x) that reach into a box."""
    # A cell counts as inside where any of its samples is.
    within = np.all((samples >= 0.0) & (samples <= np.asarray(extent)), axis=-1)
    return np.asarray(within.reshape(-1, 2, side, 2, side, 2).any(axis=(1, 3, 5)))


def read_radial(grid: RadialGrid, place: F64, density: F64, values: F64) -> F64:
    """Like `ordinate_grid.read_back`, across the octahedron's seams."""
    # Weighted by density: cells without a medium have no light to blend.
    rho = _sewn(grid, density[..., None])[..., 0]
    at = place + np.array([1.0, 1.0, 0.0])
    weight = trilinear(rho, at)
    weighted = _sewn(grid, values * density[..., None])
    read = [trilinear(weighted[..., k], at) for k in range(values.shape[-1])]
    full = weight[..., None] > 1e-12
    return np.where(full, np.stack(read, axis=-1) / np.maximum(weight, 1e-12)[..., None], 0.0)


def _sewn(grid: RadialGrid, values: F64) -> F64:
    """With a rim of one cell all round each shell, taken from across the seams."""
    # Indices of the rim lead across the octahedron's seams.
    n = grid.side
    v, u = np.meshgrid(np.arange(-1, n + 1), np.arange(-1, n + 1), indexing="ij")
    inside = np.stack([np.clip(u, 0, n - 1), np.clip(v, 0, n - 1)], axis=-1)
    over = np.stack([u, v], axis=-1) - inside
    over[..., 1] = np.where(over[..., 0] != 0, 0, over[..., 1])  # corners: any one neighbour
    other = octahedron_neighbour(inside, over, n)
    return np.asarray(values[:, other[..., 1], other[..., 0]])
