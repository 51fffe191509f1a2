"""Thousands of point lights in two arrays: sparks, embers, fireflies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import SceneError
from . import checks
from .checks import F32

MOST = 4_000_000


@dataclass(frozen=True, eq=False)
class PointLights:
    """A group of lights without extent, the same in all directions.

    `positions` (N, 3), metres, and `intensities` (N, 3), W sr^-1, linear Rec.709; one row of
    intensities holds for all. Lattices take them as low-frequency direct light, without shadow
    maps (Kaplanyan2010 section 3.1); techniques without a lattice do not show them.
    `source` is the file they came from. Raises SceneError.
    """

    positions: F32
    intensities: F32
    source: str = ""

    def __post_init__(self) -> None:
        # Arrays of the group's own, with the same number of rows or one for all.
        positions = _rows(self.positions, "positions")
        intensities = _rows(self.intensities, "intensities")
        if len(positions) > MOST:
            raise SceneError(f"{len(positions)} point lights are too many; {MOST} is the most")
        if len(intensities) not in (1, len(positions)):
            raise SceneError(
                f"{len(positions)} positions, but {len(intensities)} intensities",
                remedy="Give one row for each light, or one for all.",
            )
        if (intensities < 0.0).any():
            raise SceneError(f"intensities: row {_first(intensities < 0.0)} is negative")
        checks.at_most(positions, checks.MOST_M, "positions")
        checks.at_most(intensities, checks.MOST, "intensities")
        # One intensity for all is spread here, so that readers know one form alone.
        wide = np.broadcast_to(intensities, positions.shape)
        object.__setattr__(self, "positions", positions)
        object.__setattr__(self, "intensities", np.ascontiguousarray(wide))

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def power(self) -> float:
        """W of the brightest channel, all lights together."""
        return float(4.0 * np.pi * self.intensities.sum(axis=0, dtype=np.float64).max(initial=0.0))


def _rows(value: Any, name: str) -> F32:
    """(N, 3) finite float32 numbers of the caller's own."""
    try:
        rows = np.array(value, dtype=np.float32, ndmin=2)
    except (TypeError, ValueError):
        raise SceneError(f"{name} must be an (N, 3) array of numbers") from None
    if rows.size == 0:
        return np.zeros((0, 3), np.float32)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise SceneError(f"{name} must be an (N, 3) array, not {rows.shape}")
    if not np.isfinite(rows).all():
        raise SceneError(f"{name}: row {_first(~np.isfinite(rows))} is not finite")
    return rows


def _first(bad: Any) -> int:
    return int(np.flatnonzero(bad.any(axis=1))[0])
