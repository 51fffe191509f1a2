"""What a mesh encloses, as a density: the share of each voxel that lies inside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..maths.arrays import I64
from ..maths.closing import closed_surface, is_oriented, surface_area
from ..maths.solid_voxels import solid_voxels
from ..maths.transforms import placed_points, triple
from .checks import F32, F64, Bounds
from .mesh import Geometry

FEWEST, MOST = 64, 128
"""Voxels along the longest side of a body."""
_ACROSS = 8.0
"""Voxels that a mean chord wants: what a ray passes of the body."""
_PER_PATH = 4.0
"""Voxels that a mean free path wants: a rim between full and empty voxels is then nearly clear."""
_RIM = 1
"""Empty voxels around a body, for the slope to 0 outside of it."""


class Placed(Protocol):
    """A geometry and where it stands, as a mesh has them."""

    @property
    def geometry(self) -> Geometry:
        """In its own space."""

    @property
    def world_from_object(self) -> F64:
        """(4, 4)."""


@dataclass(frozen=True, eq=False)
class Body:
    """A closed surface: `positions` (V, 3), metres, `triangles` (T, 3), how many `holes` it had.

    Where its triangles all face one way, the inside is what it winds around; else what an odd
    number of surfaces lies before (`maths.solid_voxels`).
    """

    positions: F64
    triangles: I64
    holes: int

    @classmethod
    def of(cls, meshes: Sequence[Placed]) -> Body:
        """What the meshes, in the world, enclose together; holes are closed by plane lids."""
        positions, triangles, count = [], [], 0
        for mesh in meshes:
            matrix = mesh.world_from_object
            held = placed_points(mesh.geometry.positions.astype(np.float64), matrix)
            # A placement that mirrors turns the sides of triangles over.
            order = 1 if np.linalg.det(matrix[:3, :3]) >= 0.0 else -1
            positions.append(held)
            triangles.append(mesh.geometry.indices[:, ::order].astype(np.int64) + count)
            count += len(held)
        return cls(*closed_surface(np.concatenate(positions), np.concatenate(triangles)))

    @property
    def extent(self) -> tuple[F64, F64]:
        """The corners of the box around it."""
        used = self.positions[np.unique(self.triangles)]
        return used.min(axis=0), used.max(axis=0)

    def shares(
        self, low: F64, high: F64, count: tuple[int, int, int], at: F64 | None = None
    ) -> F64:
        """(z, y, x): how much of each of `count` (x, y, z) voxels of a box lies inside.

        `at` (4, 4): the box's space from the body's.
        """
        positions = self.positions
        if at is not None:
            positions = placed_points(positions, at)
        by_parity = not is_oriented(self.positions, self.triangles)
        return solid_voxels(positions, self.triangles, low, high, count, by_parity=by_parity)

    def density(self, free_path_m: float) -> tuple[F32, Bounds] | None:
        """1 inside, 0 outside, (z, y, x) over a box in the world; None where nothing is enclosed.

        Voxels are as small as the mean chord (4 V / A, Cauchy's formula) and the medium's mean free
        path `free_path_m` want, within FEWEST and MOST. The sum over all voxels is the body's
        volume.
        """
        low, high = self.extent
        longest = float((high - low).max())
        if not longest > 0.0:
            return None
        shares, bounds, voxel_m = self._on_cubes(longest / FEWEST)
        chord = (
            4.0 * float(shares.sum()) * voxel_m**3 / surface_area(self.positions, self.triangles)
        )
        if chord <= 1e-6 * longest:
            return None
        wanted = max(min(chord / _ACROSS, free_path_m / _PER_PATH), longest / MOST)
        if wanted < voxel_m:
            shares, bounds, _ = self._on_cubes(wanted)
        return np.asarray(shares, np.float32), bounds

    def _on_cubes(self, voxel_m: float) -> tuple[F64, Bounds, float]:
        """Shares of cubes of this side that cover the body and a rim; their box."""
        low, high = self.extent
        size = np.ceil((high - low) / voxel_m - 1e-9).astype(int).clip(1) + 2 * _RIM
        middle, half = (low + high) / 2.0, size * voxel_m / 2.0
        count = (int(size[0]), int(size[1]), int(size[2]))
        shares = self.shares(middle - half, middle + half, count)
        return shares, (triple(middle - half), triple(middle + half)), voxel_m
