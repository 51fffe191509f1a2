"""Turbulence for plumes: a periodic box of divergence-free eddies, and a noise beside them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import cast

import numpy as np

from ..checks import F32, Bounds, Vec3
from .noise import fractal_noise


@dataclass(frozen=True)
class Eddies:
    """A box of `box_m` metres in `cells`, the largest eddies of which so many fit into it.

    All along x, y, z.
    """

    box_m: Vec3
    cells: tuple[int, int, int]
    largest: tuple[int, int, int]

    def fields(self, seed: int) -> tuple[F32, F32]:
        """Periodic, divergence-free velocity (x, y, z, 3) of unit rms, and a noise (x, y, z).

        Velocity is the curl of a fractal vector potential: Bridson2007.
        """
        return _fields(self, seed)

    def look_up(self, table: F32, points: F32) -> F32:
        """The nearest entries of a periodic (x, y, z, channel) table."""
        # The cell of each point, wrapped around the box.
        size = np.array(self.cells, np.int32)
        scale = (size / np.array(self.box_m, np.float32)).astype(np.float32)
        cell = np.floor(points * scale).astype(np.int32) % size
        flat = (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2]
        return cast(F32, np.take(table.reshape(-1, table.shape[-1]), flat, axis=0))

    def between(self, table: F32, points: F32) -> F32:
        """Between the entries of a periodic (x, y, z) table, linearly."""
        size = np.array(self.cells, np.int32)
        # Values lie in the middle of cells, hence the half; the table repeats, so that eddies can
        # be moved on and on.
        at = points * (size / np.array(self.box_m)).astype(np.float32) - np.float32(0.5)
        below = np.floor(at)
        share = (at - below).T
        first = below.astype(np.int32) % size
        second = (first + 1) % size
        x, y, z = (tuple(pair) for pair in np.stack([first, second]).transpose(2, 0, 1))
        values, row, column = table.ravel(), size[1], size[2]

        # Nested by axis, so that the seven blends of a trilinear lookup go without temporaries for
        # eight corners.
        def along_z(i: int, j: int) -> F32:
            start = (x[i] * row + y[j]) * column
            low = np.take(values, start + z[0])
            return cast(F32, low + share[2] * (np.take(values, start + z[1]) - low))

        def along_y(i: int) -> F32:
            low = along_z(i, 0)
            return cast(F32, low + share[1] * (along_z(i, 1) - low))

        low = along_y(0)
        return cast(F32, low + share[0] * (along_y(1) - low))


@lru_cache(maxsize=2)
def _fields(of: Eddies, seed: int) -> tuple[F32, F32]:
    rng = np.random.default_rng(seed)
    potential = [fractal_noise(of.cells, of.largest, rng, octaves=3, gain=0.30) for _ in range(3)]

    # The curl of a vector potential has no divergence: what it stirs is neither compressed nor
    # thinned.
    def slope(component: int, axis: int) -> F32:
        field = potential[component]
        return cast(F32, np.roll(field, -1, axis) - np.roll(field, 1, axis))

    curl = np.stack(
        [slope(2, 1) - slope(1, 2), slope(0, 2) - slope(2, 0), slope(1, 0) - slope(0, 1)], axis=-1
    )
    # Of unit rms over the three components together.
    rms = np.sqrt(np.mean(np.square(curl)) * 3.0)
    # The noise has eddies of half the size.
    x, y, z = of.largest
    texture = fractal_noise(of.cells, (2 * x, 2 * y, 2 * z), rng, octaves=3, gain=0.6)
    return cast(F32, curl / rms), texture


def cell_centres(bounds: Bounds, shape: tuple[int, int, int]) -> F32:
    """World points (cells, 3), metres, of a grid of `shape` in `bounds`, in its (z, y, x) order."""
    z, y, x = (
        np.float32(bounds[0][axis])
        + (np.arange(shape[2 - axis], dtype=np.float32) + 0.5)
        * np.float32((bounds[1][axis] - bounds[0][axis]) / shape[2 - axis])
        for axis in (2, 1, 0)
    )
    zz, yy, xx = np.meshgrid(z, y, x, indexing="ij")
    return np.stack([xx.ravel(), yy.ravel(), zz.ravel()], axis=-1)
