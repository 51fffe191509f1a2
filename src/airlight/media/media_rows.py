"""Media as rows of their table on the device (`media_slots.MediumData`) without their grids."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..maths.transforms import F64
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume
from .column_texels import side_lengths
from .detail import detail_bias, detail_periods
from .emission_grids import NO_GRID, brightest_emission

BOX, ELLIPSOID, GRID = 0, 1, 2
NO_SHAFTS, SHAFTS_OF_ALL, SHAFTS_OF_LOCAL = 0, 1, 2
"""Whose single scattering is drawn by shafts; as in `wgsl/media.wgsl`."""


def voxel_m(volume: Volume) -> float:
    """The shortest side of a grid's cells in the world, metres."""
    assert volume.density is not None
    return float((side_lengths(volume) / np.array(volume.density.shape[::-1])).min())


def kind_of(volume: Volume) -> int:
    """The kind of a volume's medium."""
    return {"grid": GRID, "box": BOX, "sphere": ELLIPSOID}[volume.shape]


def gridded(scene: Scene) -> list[Volume]:
    """The volumes that have a grid."""
    return [v for v in scene.volumes if v.density is not None]


def row_kinds(scene: Scene) -> tuple[int, ...]:
    """The kinds of all media, in the order of their rows."""
    own = () if scene.medium is None else (BOX,)
    return (*own, *(kind_of(volume) for volume in scene.volumes))


def unit_from_box(low: F64, high: F64) -> F64:
    """(4, 4): the box low..high to 0..1; a flat side is given a hair of thickness."""
    size = np.maximum(np.subtract(high, low), 1e-9)
    matrix = np.diag([*(1.0 / size), 1.0])
    matrix[:3, 3] = -np.asarray(low) / size
    return matrix


def medium_fields(
    of: Medium | Volume, kind: int, volume_from_world: F64, *, shafts: int
) -> dict[str, Any]:
    """A row without grids; `shafts`: which lights' single scattering they draw."""
    # No grid, no glow by voxels, no noise: those that have some write over it.
    return {
        "volume_from_world": volume_from_world,
        "sigma_t": of.sigma_t,
        "kind": kind,
        "albedo": of.albedo,
        "phase": 0,
        "g": of.g,
        "shafts": shafts,
        "emission": brightest_emission(of),
        "emission_first": NO_GRID.first,
        "emission_count": NO_GRID.count,
        "voxel": 0.0,
        "detail": 0.0,
        "detail_bias": 0.0,
        "detail_periods": (0.0, 0.0, 0.0),
        "grid_first": (0.0, 0.0, 0.0),
        "grid_count": (1.0, 1.0, 1.0),
        "columns_first": (0.0, 0.0, 0.0),
        "columns_count": (2.0, 2.0, 2.0),
        "nodes": np.zeros((4, 4)),
    }


def member_bits(rows: Sequence[int]) -> dict[str, tuple[int, ...]]:
    """Rows of media as bits of `members_low` and `members_high`; see `wgsl/members.wgsl`."""
    # A bit for each of at most 256 media.
    words = [0] * 8
    for row in rows:
        words[row // 32] |= 1 << row % 32
    return {"members_low": tuple(words[:4]), "members_high": tuple(words[4:])}


def has_detail(scene: Scene) -> bool:
    """Whether any grid has noise below its voxels."""
    return any(v.detail > 0.0 and v.density is not None for v in scene.volumes)


def detail_fields(volume: Volume) -> dict[str, Any]:
    """The noise, and steps short enough to see it."""
    return {
        "detail": volume.detail,
        "detail_bias": detail_bias(volume.detail),
        "detail_periods": detail_periods(volume),
        "voxel": 0.5 * voxel_m(volume),
    }
