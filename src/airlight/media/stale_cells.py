"""Cells whose light of the sky is another since some of the media changed, as a list.

A cell sums up a hundred lights, each through all media; few of them come through the box of a
medium that moved, and most cells have none that does. A cell that reaches into such a box is
listed, too: what it scatters changes, and the mean of light over what scatters. Passes with the
slot `STALE_CELL_SLOTS` and `//! use listed_cells` compute the listed cells alone; each comes out as
if all had been computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ..gpu.memory import Buffer, Texture
from ..gpu.rows import Table, table
from ..gpu.slots import Slot, sampler, storage, texture, uniform
from ..lattice.placement import LatticeParams, Placement
from ..surface.light_table import LightData
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps
from ..surface.shadow import comparison_sampler
from .media_changes import MOST_BOXES

STALE_CELL_SLOTS: tuple[Slot, ...] = (storage("stale_cells", "u32"),)
"""Of passes that use `wgsl/listed_cells.wgsl`: how many cells there are, then their indices."""
LISTED_CELLS, ALL_CELLS = "//! use listed_cells\n", "//! use all_cells\n"
"""Lines of shaders whose passes over cells may be given a list, and of those that may not."""


class StaleCellParams(Struct):
    """Numbers of lights and boxes."""

    light_count = u32()
    boxes = u32()


class TouchedBox(Struct):
    """The box of a medium before or after it changed; it is 0..1 on each axis of its own space."""

    volume_from_world = mat4x4f()
    centre = vec3f("m")
    radius = f32("m, of the ball about it")


class _StaleCells(ComputePass):
    workgroup = (32, 4, 2)
    slots = (
        uniform("params", StaleCellParams),
        uniform("lattice", LatticeParams),
        table("lights", LightData),
        table("views", LightViewData),
        texture("depth", "2d-array", "depth"),
        sampler("compare", "comparison"),
        texture("lattice_walls", "3d"),
        storage("boxes", TouchedBox),
        storage("stale_cells", "atomic<u32>", "read_write"),
    )


@dataclass(frozen=True, eq=False)
class SkyLights:
    """The sky's lights, rows of a `table`, with their maps; `walls` as `Blockers.walls`."""

    table: Table
    count: int
    maps: ReflectiveShadowMaps
    walls: Texture


class StaleCells:
    """A list of cells, of one reader: boxes are the same for all of its lattices in a frame."""

    def __init__(self, gpu: Gpu, most: int) -> None:
        """For lattices of at most so many cells."""
        self._pass = _StaleCells(gpu)
        self._compare = comparison_sampler(gpu)
        self._boxes = Buffer(gpu, "touched boxes", TouchedBox.dtype.itemsize * MOST_BOXES)
        self.listed = Buffer(gpu, "stale cells", 4 * (1 + most))
        self.is_listed = False
        """Whether the list counts; else all cells are to be computed."""

    def find(
        self,
        commands: Commands,
        boxes: NDArray[np.float32] | None,
        placement: Placement,
        sky: SkyLights,
    ) -> None:
        """List the cells of a lattice that the sky's light reaches through `boxes`, or in them.

        None: changes may be anywhere.
        """
        self.is_listed = boxes is not None
        if boxes is None:
            return
        # What changed lies in these boxes, where it was and where it is.
        if len(boxes):
            self._boxes.write(_touched(boxes))
        # The list begins with its length, which cells count up as they enter.
        commands.encoder.clear_buffer(self.listed.handle, 0, 4)
        self._pass.dispatch(
            commands,
            placement.count,
            params=StaleCellParams(light_count=sky.count, boxes=len(boxes)),
            lattice=placement.params(),
            lights=sky.table,
            views=sky.maps.views,
            depth=sky.maps.depth,
            compare=self._compare,
            lattice_walls=sky.walls,
            boxes=self._boxes,
            stale_cells=self.listed,
        )

    @property
    def bound(self) -> dict[str, Any]:
        """By the names of STALE_CELL_SLOTS."""
        return {"stale_cells": self.listed}


def _touched(boxes: NDArray[np.float32]) -> NDArray[Any]:
    """Rows of `TouchedBox`, with the balls about them."""
    rows = np.zeros(len(boxes), TouchedBox.dtype)
    rows["volume_from_world"] = boxes
    # Columns come first in a packed matrix: a row here is an axis of the box.
    to_world = np.linalg.inv(boxes.astype(np.float64))
    rows["centre"] = (np.array([0.5, 0.5, 0.5, 1.0]) @ to_world)[:, :3]
    # Half its diagonals; the other four are opposite to these.
    corners = np.array([(1.0, y, z) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    half_diagonals = np.linalg.norm(0.5 * corners @ to_world[:, :3, :3], axis=2)
    rows["radius"] = half_diagonals.max(axis=1)
    return rows
