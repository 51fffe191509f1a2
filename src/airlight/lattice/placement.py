"""Where the cells of a lattice are in the world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SettingsError
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..maths.lattice6 import LOOKUP_SCALE

F64 = NDArray[np.float64]
_TILE = 2  # the marching kernel works on columns of 2 x 2 cells


class LatticeParams(Struct):
    """A placement, as shaders see it."""

    origin = vec3f("m")
    cell = f32("m")
    count = vec3u("cells")
    power_scale = f32("stored units per W sr^-1 of the filtered textures")
    lookup_scale = f32("flux through a cell to irradiance on a surface in it")
    is_paper = u32("1: the paper's rule for reading the lattice on surfaces")
    pad = vec3u()


@dataclass(frozen=True)
class Placement:
    """Cubic cells of side `cell` (metres); cell (i, j, k) spans origin + cell * [i, i+1] ..."""

    origin: tuple[float, float, float]
    cell: float
    count: tuple[int, int, int]

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self.count[0] * self.count[1] * self.count[2]

    @property
    def bounds(self) -> tuple[F64, F64]:
        """Lower and upper corner, metres."""
        low = np.array(self.origin)
        return low, low + self.cell * np.array(self.count)

    def params(
        self, power_scale: float = 1.0, *, lookup_scale: float = LOOKUP_SCALE,
        is_paper: bool = False,
    ) -> LatticeParams:  # fmt: skip
        """The struct that shaders read."""
        return LatticeParams(
            origin=self.origin, cell=self.cell, count=self.count, power_scale=power_scale,
            lookup_scale=lookup_scale, is_paper=int(is_paper), pad=(0, 0, 0),
        )  # fmt: skip


def fitted(low: Sequence[float] | F64, high: Sequence[float] | F64, resolution: int) -> Placement:
    """Cubic cells over the box low..high (metres), `resolution` of them along its longest side.

    One cell of margin all around keeps surfaces on the box's faces inside. Shorter sides get
    fewer cells. Raises SettingsError for an empty box.
    """
    extent = np.subtract(high, low).astype(np.float64)
    if not np.isfinite(extent).all() or extent.max() <= 0.0:
        raise SettingsError(f"the lattice has no size: {list(low)} to {list(high)}")
    if resolution < 4:
        raise SettingsError(f"resolution = {resolution} is too small for a lattice")
    cell = float(extent.max()) / (resolution - 2)
    needed = np.ceil(extent / cell - 1e-9).astype(int) + 2
    count = np.minimum(-(-needed // _TILE) * _TILE, -(-resolution // _TILE) * _TILE)
    centre = 0.5 * np.add(low, high)
    origin = centre - 0.5 * cell * count
    return Placement(
        (float(origin[0]), float(origin[1]), float(origin[2])),
        cell,
        (int(count[0]), int(count[1]), int(count[2])),
    )
