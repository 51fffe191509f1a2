"""Lights with shadow maps, as passes over cells gather them (`wgsl/cell_light.wgsl`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..gpu.memory import Texture
from ..gpu.slots import Slot, texture
from ..surface.light_table import SHADOWED_LIGHT_SLOTS

CELL_LIGHT_SLOTS: tuple[Slot, ...] = (
    *SHADOWED_LIGHT_SLOTS,
    texture("lattice_walls", "3d"),
)
"""Of passes that use `wgsl/cell_light.wgsl`; `CellLights` binds them."""
# Walls are those of the level that is lit, all else is the lights' own.
_OF_LIGHTS = tuple(slot.name for slot in CELL_LIGHT_SLOTS if slot.name != "lattice_walls")

ALL_LIGHTS = """fn shining_light(i: u32) -> LightData { return row_of_lights(i); }
const IS_SKY = false;
"""
SKY_LIGHTS = """fn shining_light(i: u32) -> LightData {
    var light = row_of_lights(i);
    light.kind = LIGHT_DIRECTIONAL;
    return light;
}
const IS_SKY = true;
"""
"""Lines of passes over cells: any lights, or the sky's, for which compilers drop what is local."""


@dataclass(frozen=True, eq=False)
class CellLights:
    """The lights that shine into a lattice.

    `resources`: table, views and shadow maps by slot name, as Lights.bound. `count`: so many of the
    table's rows shine. `walls`: as `Blockers.walls`; nothing is gathered from behind them.
    """

    resources: Mapping[str, Any]
    count: int
    walls: Texture

    @property
    def bound(self) -> dict[str, Any]:
        """By the names of CELL_LIGHT_SLOTS."""
        of_lights = {name: self.resources[name] for name in _OF_LIGHTS}
        return {**of_lights, "lattice_walls": self.walls}
