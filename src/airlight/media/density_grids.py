"""The density grids of a scene on the device, once for all that read them.

A technique has several tables of media (as they are, reduced, under its lights, under the sky's),
all of the same grids in the same places. Their texture and their columns towards lights do not
depend on coefficients, so one of each serves all tables.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..gpu.device import Gpu
from ..gpu.shared import Shared
from ..scene.volume import Volume
from .atlas import DensityAtlas
from .column_texels import Fineness
from .light_columns import LightColumns

_SKY_TEXELS = 16
_TEXELS_PER_CELL = 2  # cells look for light at points half a cell apart


@dataclass(frozen=True, eq=False)
class ColumnPlan:
    """Which columns towards lights a table of media reads.

    `resolution`: texels along the longest side of a grid at most, up to three times as many in
    matter so dense that a texel's optical depth is beyond `texel_depth`. `texel_m`: they need not
    be finer than this, metres. `towards` says whose lights they are; tables of the same name and
    lights have the same columns where they are of the same `shared`.
    """

    resolution: int = 48
    texel_m: float = 0.0
    texel_depth: float = 1.0
    towards: str = "lights"
    shared: Shared | None = None


def sky_columns(cell_m: float, shared: Shared) -> ColumnPlan:
    """Columns towards the many lights of a sky, which cells of a side of `cell_m` read."""
    return ColumnPlan(_SKY_TEXELS, cell_m / _TEXELS_PER_CELL, math.inf, "sky", shared)


def density_atlas(gpu: Gpu, volumes: Sequence[Volume], shared: Shared) -> DensityAtlas:
    """The grids of `volumes`, all of which have one."""
    densities = [v.density for v in volumes if v.density is not None]
    # The atlas keeps the arrays, so that no other array is taken for one of them.
    key = ("densities", *map(id, densities))
    return shared.once(key, lambda: DensityAtlas(gpu, densities))


def light_columns(
    gpu: Gpu, volumes: Sequence[Volume], light_count: int, plan: ColumnPlan, shared: Shared
) -> LightColumns:
    """Their columns towards `light_count` lights."""
    atlas = density_atlas(gpu, volumes, shared)
    fineness = Fineness(plan.resolution, plan.texel_m, plan.texel_depth)
    # Tables of the same grids, lights and fineness read the same columns.
    key = ("columns", id(atlas), light_count, fineness, plan.towards)
    return shared.once(key, lambda: LightColumns(gpu, atlas, volumes, light_count, fineness))
