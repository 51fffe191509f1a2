"""Grids that lie anywhere, brought onto the voxels of one box that holds them all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import SceneError
from ..maths.transforms import placed_points
from .checks import F32, F64, Bounds

LONGEST_SIDE = 2048
"""Voxels along a side; what every graphics device takes."""

_SAME = 1e-3  # of a voxel: closer than that two grids are the same


@dataclass(frozen=True, eq=False)
class GridBox:
    """Where a grid of `shape` (z, y, x) lies: `bounds`, metres, and what comes after them."""

    shape: tuple[int, ...]
    bounds: Bounds
    world_from_volume: F64

    @property
    def world_from_voxels(self) -> F64:
        """(4, 4) from voxel corners 0..n along x, y, z."""
        low, high = np.array(self.bounds)
        matrix = np.diag([*((high - low) / self.shape[2::-1]), 1.0])
        matrix[:3, 3] = low
        return np.asarray(self.world_from_volume @ matrix)

    @property
    def voxel_m3(self) -> float:
        """The volume of a voxel."""
        return abs(float(np.linalg.det(self.world_from_voxels[:3, :3])))

    def from_other(self, other: GridBox) -> F64:
        """(4, 4) from voxel corners of another grid to those of this one."""
        return np.asarray(np.linalg.inv(self.world_from_voxels) @ other.world_from_voxels)

    def holding(self, other: GridBox) -> GridBox:
        """This box with as many whole voxels more as the other one needs beyond it.

        Raises SceneError where they lie farther apart than a grid may be long.
        """
        to_own = self.from_other(other)
        size = np.array(other.shape[2::-1], np.float64)
        corners = np.array(np.meshgrid(*[(0.0, n) for n in size])).reshape(3, 8).T
        placed = placed_points(corners, to_own)
        # Whole voxels that are needed on each side.
        count = np.array(self.shape[::-1])
        before = np.maximum(np.ceil(-placed.min(axis=0) - _SAME), 0.0)
        after = np.maximum(np.ceil(placed.max(axis=0) - count - _SAME), 0.0)
        if before.max() + after.max() > LONGEST_SIDE:
            raise SceneError("its grids lie far apart", remedy="Give each a volume of its own.")
        if not (before.any() or after.any()):
            return self
        # Voxels are added whole, so that those of the grid keep their places and values.
        low, high = np.array(self.bounds)
        voxel = (high - low) / count
        first, last = low - before * voxel, high + after * voxel
        bounds: Bounds = ((first[0], first[1], first[2]), (last[0], last[1], last[2]))
        shape = (count + before + after).astype(int)[::-1]
        return GridBox(
            (int(shape[0]), int(shape[1]), int(shape[2])), bounds, self.world_from_volume
        )

    def values_of(self, values: F32, other: GridBox) -> F32:
        """`values` (z, y, x) or (z, y, x, channel) of another grid on the voxels of this one.

        They are trilinear between voxels, and 0 outside their own box; the very same where both
        grids are one.
        """
        to_own = self.from_other(other)
        # Grids that coincide, as most do, are used as they are.
        if other.shape == self.shape and np.abs(to_own - np.eye(4)).max() < _SAME * 1e-2:
            return values
        # Those whose voxels coincide are moved by whole voxels.
        offset = np.round(to_own[:3, 3]).astype(int)
        aligned = np.eye(4)
        aligned[:3, 3] = offset
        reach = float(max(*self.shape, *other.shape))
        if np.abs(to_own - aligned)[:3, :3].max() * reach < _SAME and (
            np.abs(to_own[:3, 3] - offset).max() < _SAME
        ):
            return _moved(values, offset, self.shape)
        return _resampled(values, to_own, self.shape)


def _moved(values: F32, offset: Any, shape: tuple[int, ...]) -> F32:
    """`values` in a grid of `shape` (z, y, x), from voxel `offset` (x, y, z) on."""
    made = np.zeros((*shape, *values.shape[3:]), np.float32)
    # The part of both that they share, along each axis.
    starts = np.maximum(offset[::-1], 0)
    ends = np.minimum(offset[::-1] + values.shape[:3], shape)
    if (ends > starts).all():
        own = tuple(slice(int(a), int(b)) for a, b in zip(starts, ends, strict=True))
        at = [(int(a - o), int(b - o)) for a, b, o in zip(starts, ends, offset[::-1], strict=True)]
        made[own] = values[tuple(slice(a, b) for a, b in at)]
    return made


def _resampled(values: F32, to_voxels: F64, shape: tuple[int, ...]) -> F32:
    """`values` at the centres of a grid of `shape` (z, y, x), trilinear, a slice at a time.

    `to_voxels`: from corners of the voxels of `values` to those of the new grid.
    """
    # A border of zeros around the values makes them fade out across a voxel.
    inverse = np.linalg.inv(to_voxels)
    made = np.zeros((*shape, *values.shape[3:]), np.float32)
    padded = np.pad(values, [(1, 1)] * 3 + [(0, 0)] * (values.ndim - 3))
    size = np.array(padded.shape[2::-1])
    # A slice at a time, so that coordinates of the whole grid are never in memory.
    y, x = np.meshgrid(np.arange(shape[1]) + 0.5, np.arange(shape[2]) + 0.5, indexing="ij")
    for z in range(shape[0]):
        centres = np.stack([x, y, np.full_like(x, z + 0.5)], axis=-1)
        # Voxel centres of the padded grid lie at whole numbers.
        at = placed_points(centres, inverse) + 0.5
        inside = ((at >= 0.0) & (at <= size - 1)).all(axis=-1)
        at = at[inside]
        # Trilinear: each of the eight voxels around counts by its distance along each axis.
        low = np.minimum(at.astype(int), size - 2)
        share = (at - low).astype(np.float32)
        total = np.zeros((len(at), *values.shape[3:]), np.float32)
        for k in range(8):
            corner = np.array([k & 1, k >> 1 & 1, k >> 2])
            weight = np.where(corner, share, 1.0 - share).prod(axis=-1)
            i, j, m = (low + corner).T
            total += weight.reshape(-1, *[1] * (values.ndim - 3)) * padded[m, j, i]
        made[z][inside] = total
    return made
