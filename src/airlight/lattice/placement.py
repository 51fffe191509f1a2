"""The placement of a lattice's cells in the world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SettingsError
from ..gpu.layout import Struct, f32, u32, vec3f, vec3u
from ..maths.arrays import F64
from ..maths.lattice6 import LOOKUP_SCALE
from ..maths.transforms import box_along, triple

_TILE = 2  # CPU adapters propagate pairs of cells (lpv.step)


class LatticeParams(Struct):
    """A placement, as shaders read it."""

    axis_x = vec3f("unit vector of the world, as the next two; what follows is along them")
    axis_y = vec3f()
    axis_z = vec3f()
    origin = vec3f("m")
    cell = f32("m")
    count = vec3u("cells")
    power_scale = f32("stored units per W sr^-1 of the filtered textures")
    lookup_scale = f32("flux through a cell to irradiance on a surface in it")
    is_paper = u32("1: the paper's rule for reading the lattice on surfaces")
    first_row = u32("where its cells begin along y of the textures")
    fade_low = vec3f("m, where its light begins")
    fade_low_width = vec3f("m, to where it is whole")
    fade_high = vec3f("m, where its light ends")
    fade_high_width = vec3f("m")


class LatticeSize(Struct):
    """The size of a lattice, for passes that need not know where it is."""

    count = vec3u("cells")


Triple = tuple[float, float, float]
Axes = tuple[Triple, Triple, Triple]
"""Unit vectors of the world, at right angles, along which a lattice's cells lie."""
STRAIGHT: Axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
"""Those of the world itself."""
Hull = tuple[Triple, Triple]
"""Corners, metres along the lattice's axes, of a box around all surfaces: no light comes back from
beyond it.
"""
EVERYWHERE: Hull = ((-1e30,) * 3, (1e30,) * 3)


@dataclass(frozen=True)
class Fade:
    """Where a lattice's light fades in and out on each axis, and over which widths; metres."""

    low: Triple
    low_width: Triple
    high: Triple
    high_width: Triple


@dataclass(frozen=True)
class Placement:
    """Cubic cells of side `cell` (metres); cell (i, j, k) spans origin + cell * [i, i+1] ...

    `origin` and `fade` are metres along `axes`: R p for a point p of the world, where the rows of R
    are the axes (twin: wgsl/lattice_axes.wgsl). Nested lattices have the same ones. `first_row`:
    nested lattices share their textures, one above the other along y. `fade`: where the next
    coarser one takes over; over the outermost cell if not given.
    """

    origin: tuple[float, float, float]
    cell: float
    count: tuple[int, int, int]
    first_row: int = 0
    fade: Fade | None = None
    axes: Axes = STRAIGHT

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self.count[0] * self.count[1] * self.count[2]

    @property
    def bounds(self) -> tuple[F64, F64]:
        """Lower and upper corner, metres along its axes."""
        low = np.array(self.origin)
        return low, low + self.cell * np.array(self.count)

    @property
    def world_bounds(self) -> tuple[F64, F64]:
        """Lower and upper corner, metres, of the world's box around it."""
        return box_along(np.array(self.axes).T, *self.bounds)

    def params(
        self,
        power_scale: float = 1.0,
        *,
        lookup_scale: float = LOOKUP_SCALE,
        is_paper: bool = False,
    ) -> LatticeParams:
        """The struct that shaders read."""
        return _params(self, power_scale, lookup_scale, is_paper)

    @property
    def borders(self) -> Fade:
        """The fade of the lattice; by default over the outermost cell."""
        if self.fade is not None:
            return self.fade

        # From half a cell outside the lattice to the middle of its outermost cell.
        low, high = self.bounds
        half, width = 0.5 * self.cell, (self.cell,) * 3
        return Fade(triple(low - half), width, triple(high + half), width)


@lru_cache(maxsize=256)
def _params(
    placement: Placement, power_scale: float, lookup_scale: float, is_paper: bool
) -> LatticeParams:
    """One struct, cached for all who read the same lattice."""
    fade = placement.borders
    axis_x, axis_y, axis_z = placement.axes
    return LatticeParams(
        axis_x=axis_x,
        axis_y=axis_y,
        axis_z=axis_z,
        origin=placement.origin,
        cell=placement.cell,
        count=placement.count,
        power_scale=power_scale,
        lookup_scale=lookup_scale,
        is_paper=int(is_paper),
        first_row=placement.first_row,
        fade_low=fade.low,
        fade_low_width=fade.low_width,
        fade_high=fade.high,
        fade_high_width=fade.high_width,
    )


def fitted(
    low: Sequence[float] | F64,
    high: Sequence[float] | F64,
    resolution: int,
    axes: Axes = STRAIGHT,
) -> Placement:
    """Cubic cells over the box low..high (metres), `resolution` of them along its longest side.

    The box's corners are along `axes`.

    One cell of margin all around keeps surfaces on the box's faces inside. Shorter sides get
    fewer cells. Raises SettingsError for an empty box.
    """
    # The longest side decides how large cells are, with one of margin at either end.
    extent = np.subtract(high, low).astype(np.float64)
    if not np.isfinite(extent).all() or extent.max() <= 0.0:
        ends = (", ".join(f"{v:g}" for v in end) for end in (low, high))
        raise SettingsError("the lattice has no size: [{}] to [{}]".format(*ends))
    if resolution < 4:
        raise SettingsError(f"resolution = {resolution} is too small for a lattice")
    cell = float(extent.max()) / (resolution - 2)
    needed = np.ceil(extent / cell - 1e-9).astype(int) + 2
    count = tiled(np.minimum(needed, resolution))
    # The lattice is centred on the box.
    centre = 0.5 * np.add(low, high)
    origin = centre - 0.5 * cell * np.array(count)
    return Placement(triple(origin), cell, count, axes=axes)


def tiled(cells: NDArray[Any]) -> tuple[int, int, int]:
    """Numbers of cells (3,) rounded up to pairs, as propagation works on them."""
    x, y, z = (int(-(-n // _TILE) * _TILE) for n in cells.tolist())
    return (x, y, z)
