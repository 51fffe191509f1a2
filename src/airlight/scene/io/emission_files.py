"""Emission and temperature grids of a volume's file, on the voxels of its density."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ..checks import F32, F64, Bounds
from ..emission import WHITE, Emission
from .files import naming
from .volumes import LONGEST_SIDE, GridValues, VolumeGrid, read_values

KEYS = ("temperature_scale", "temperature_offset")
_SAME = 1e-3  # of a voxel: closer than that two grids are the same


def taken_emission(
    values: dict[str, Any], path: Path | None, density: VolumeGrid | None
) -> tuple[Emission | None, VolumeGrid | None]:
    """The emission that a [[volume]]'s keys describe; takes them out of `values`.

    The density comes back on a larger box where the emission reaches beyond its own. Raises
    SceneError for what cannot be read, a temperature below 0 K, and keys that do not fit.
    """
    # All keys are taken out, also those that are wrong together: what stays belongs to others.
    wanted, hot = values.pop("emission_grid", None), values.pop("temperature_grid", None)
    given = {name: values.pop(name) for name in KEYS if name in values}
    radiance = values.pop("emission", None)
    # Keys that contradict each other, or have nothing to describe.
    if wanted is not None and hot is not None:
        raise SceneError("has an emission_grid and a temperature_grid", remedy="Keep one of them.")
    if given and hot is None:
        raise SceneError(f"{next(iter(given))} belongs to a temperature_grid")
    if wanted is None and hot is None:
        # Without a grid the emission is in proportion to the density.
        return (Emission(radiance) if radiance else None), density
    if path is None or density is None:
        name = "emission_grid" if hot is None else "temperature_grid"
        raise SceneError(f"{name} belongs to a file, not to a shape")
    # Density and emission, on one grid that holds both.
    with naming(path):
        found = read_values(path, wanted or hot or "")
        if hot is not None and found.values.ndim != 3:
            raise SceneError(f"'{hot}' has {found.values.shape[3]} channels, a temperature has one")
        density, grid = on_one_grid(density, found)
        if grid.ndim == 4 and grid.shape[3] != 3:
            raise SceneError(f"'{wanted}' has {grid.shape[3]} channels, colours have three")
        named: dict[str, Any] = {"temperature" if hot else "grid": grid}
        return Emission(radiance or WHITE, **named, **given), density


def on_one_grid(
    density: VolumeGrid, other: GridValues, *, grows: bool = True
) -> tuple[VolumeGrid, F32]:
    """Both on voxels of the density's size, over a box that holds both; 0 outside their own.

    Unless it `grows`, the density keeps its box.
    """
    # Where the other grid lies, in voxels of the density.
    to_density = np.linalg.inv(_world_from_voxels(density.density, density)) @ _world_from_voxels(
        other.values, other
    )
    size = np.array(other.values.shape[2::-1], np.float64)
    corners = np.array(np.meshgrid(*[(0.0, n) for n in size])).reshape(3, 8).T
    placed = corners @ to_density[:3, :3].T + to_density[:3, 3]
    # Whole voxels of the density that the other grid needs beyond it.
    count = np.array(density.density.shape[::-1])
    before = grows * np.maximum(np.ceil(-placed.min(axis=0) - _SAME), 0.0).astype(int)
    after = grows * np.maximum(np.ceil(placed.max(axis=0) - count - _SAME), 0.0).astype(int)
    if (before.max(initial=0) + after.max(initial=0)) > LONGEST_SIDE:
        raise SceneError("its grids lie far apart", remedy="Give each a volume of its own.")
    grown = _grown(density, before, after)
    # Grids that coincide, as most do, are used as they are.
    is_same = np.abs(to_density - np.eye(4)).max() < _SAME * 1e-2
    if is_same and other.values.shape[:3] == grown.density.shape:
        return grown, other.values
    # Else the other grid is resampled, from an origin that has moved by the voxels before it.
    to_density[:3, 3] += before
    return grown, _resampled(other.values, to_density, grown.density.shape)


def _world_from_voxels(values: F32, placed: VolumeGrid | GridValues) -> F64:
    """(4, 4) from voxel corners 0..n along x, y, z."""
    low, high = np.array(placed.bounds)
    matrix = np.diag([*((high - low) / values.shape[2::-1]), 1.0])
    matrix[:3, 3] = low
    return np.asarray(placed.world_from_volume @ matrix)


def _grown(grid: VolumeGrid, before: Any, after: Any) -> VolumeGrid:
    """With so many voxels more on each side, x y z, of no density."""
    if not (before.any() or after.any()):
        return grid
    low, high = np.array(grid.bounds)
    # Voxels are added whole, so that those of the density keep their places and values.
    voxel = (high - low) / grid.density.shape[::-1]
    sides = [(int(b), int(a)) for b, a in zip(before[::-1], after[::-1], strict=True)]
    first, last = low - before * voxel, high + after * voxel
    bounds: Bounds = ((first[0], first[1], first[2]), (last[0], last[1], last[2]))
    return replace(grid, density=np.pad(grid.density, sides), bounds=bounds)


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
        at = centres @ inverse[:3, :3].T + inverse[:3, 3] + 0.5
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
