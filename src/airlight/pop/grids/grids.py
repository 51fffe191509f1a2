"""The grids that light hops in, one per ordinate and lamp, and the air in them.

See `maths.ordinate_grid` and `maths.radial_grid`. All have room for the same number of cells, so
that one dispatch goes through all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, u32, vec3f, vec3u
from ...gpu.memory import Buffer, buffer_of
from ...gpu.slots import sampler, storage, texture, uniform
from ...maths.octahedron import octahedron_cell_solid_angles
from ...maths.ordinate_grid import ordinate_grids
from ...maths.ordinates import Ordinates
from ...maths.radial_grid import RadialGrid, radial_grid, shell_growth
from ..light.ordinates import Lamp
from ..medium.density import Density
from ..medium.placement import MediumParams, MediumPlacement

FAR = 2.0
"""A lamp this many half diagonals from the middle of a medium gets a parallel grid: seen from
there, a shell's cells are wider than the medium."""
FIXED_POINT_BITS = 30
GROUP = 64
"""Cells that hop together."""
MOST_GROUPS = 32768
"""At once; a device takes 65535. Where cells are more, each goes through several lots of them."""


class HopGridData(Struct):
    """One grid in the medium's frame: parallel to an ordinate, or shells around a lamp."""

    axis_x = vec3f()
    cell = f32("m; of a parallel grid")
    axis_y = vec3f()
    radius = f32("m; outer, of a radial grid")
    axis_z = vec3f("travel of parallel light")
    mean_cosine = f32("of the ordinate's part of the sky")
    corner = vec3f("m; a radial grid's centre")
    growth = f32("of shells")
    count = vec3u("cells; z along the light; none: no light")
    is_radial = u32()
    fixed_scale = f32("in the first row: integers per W of residuum around lamps")


class HopParams(Struct):
    """One dispatch over all grids."""

    eye = vec3f("m, in the medium's frame")
    capacity = u32("cells that each grid has room for")
    grids = u32("how many there are")
    first_row = u32("the first grid's light among the ordinates")
    first_lamp = u32("grid of the first lamp")
    columns = u32("of a grid that begin together")
    is_paper = u32()
    is_last = u32("1: what is left joins the residuum")
    is_added = u32("1: to the deposits of beams")


_CONSTANTS = f"const GROUP = {GROUP}u;\nconst MOST_GROUPS = {MOST_GROUPS}u;\n"


class _Fill(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("hops", HopParams),
        storage("grids", HopGridData),
        storage("solid_angles", "f32"),
        texture("fine", "3d"),
        sampler("linear_clamp"),
        storage("hop_rho", "f32", "read_write"),
        storage("listed", "atomic<u32>", "read_write"),
        storage("groups", "atomic<u32>", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "density.wgsl"


class HopGrids:
    """`rows`, HopGridData of every ordinate, then every lamp; `density`, f32 [grid][z][y][x].

    `listed`: how many cells light may hop from, then grid * `capacity` + cell of each in any order;
    `groups` of `GROUP` of them, to dispatch. Most cells around a lamp beside the medium are not.
    """

    def __init__(self, gpu: Gpu, placement: MediumPlacement, side: int, most: int) -> None:
        """At most `most` grids of about `side`^3 cells."""
        self._placement = placement
        self.side = side + side % 2
        self.shells = side
        self.capacity = hop_capacity(side)
        self.rows = Buffer(gpu, "hop grids", HopGridData.dtype.itemsize * most)
        self.density = Buffer(gpu, "density of hop grids", 4 * self.capacity * most)
        self.listed = Buffer(gpu, "cells of hop grids", 4 * (1 + self.capacity * most))
        self.groups = Buffer(gpu, "groups of hop cells", 16, indirect=True)
        angles = octahedron_cell_solid_angles(self.side).astype(np.float32)
        self.solid_angles = buffer_of(gpu, "solid angles", angles)
        self._fill = _Fill(gpu, generated=_CONSTANTS)
        self.columns = 1
        self.first_row = self.ordinates = self.lamps = self.virtual = 0
        self.lamp_power = 0.0

    @property
    def growth(self) -> float:
        """Of shells."""
        return shell_growth(self.side)

    @property
    def count(self) -> int:
        """How many there are: of ordinates, lamps and virtual lights, in this order."""
        return self.ordinates + self.lamps + self.virtual

    def write(
        self,
        ordinates: Ordinates,
        lamps: Sequence[Lamp],
        placement: MediumPlacement,
        *,
        prefilter: bool,
        scale: float,
        virtual: int = 0,
        first_row: int = 0,
    ) -> None:
        """Place the grids; `scale` W m^-2 as in the ordinates' table, whose rows from `first_row`
        on they are. The last `virtual` lights' are placed on the device.
        """
        self._placement, self.first_row = placement, first_row
        self.ordinates, self.lamps, self.virtual = ordinates.count, len(lamps), virtual
        cells = self.capacity
        rows = hop_rows(ordinates, lamps, placement, cells, self.side, self.shells)
        if not prefilter:
            rows["mean_cosine"] = 1.0
        least = self.side**2 if virtual else 1
        self.columns = int(np.max(rows["count"][:, 0] * rows["count"][:, 1], initial=least))
        self.lamp_power = sum(4.0 * np.pi * max(lamp.intensity) / scale for lamp in lamps)
        power = self.lamp_power if self.lamp_power > 0.0 else 1.0
        rows["fixed_scale"][:1] = float(2**FIXED_POINT_BITS) / power
        if len(rows):
            self.rows.write(rows)

    def params(
        self, eye: Any, *, is_paper: bool, is_last: bool = False, is_added: bool = False
    ) -> HopParams:
        """For an eye (3,), m in the medium's frame."""
        return HopParams(
            eye=eye,
            capacity=self.capacity,
            grids=self.count,
            first_row=self.first_row,
            first_lamp=self.ordinates,
            columns=self.columns,
            is_paper=int(is_paper),
            is_last=int(is_last),
            is_added=int(is_added),
        )

    def encode(
        self, commands: Commands, params: MediumParams, hops: HopParams, density: Density
    ) -> None:
        """Fill `density`, and list the cells."""
        for counted in (self.listed, self.groups):
            commands.encoder.clear_buffer(counted.handle)
        self._fill.dispatch(
            commands,
            (self.capacity, max(1, self.count)),
            params=params,
            hops=hops,
            grids=self.rows,
            solid_angles=self.solid_angles,
            fine=density.fine,
            linear_clamp=density.linear,
            hop_rho=self.density,
            listed=self.listed,
            groups=self.groups,
        )


def hop_capacity(side: int) -> int:
    """Cells that each grid of about `side`^3 has room for: shells have an even number."""
    return (side + side % 2) ** 2 * side


def hop_rows(
    ordinates: Ordinates,
    lamps: Sequence[Lamp],
    placement: MediumPlacement,
    cells: int,
    side: int,
    shells: int,
) -> np.ndarray[Any, np.dtype[Any]]:
    """`HopGridData` of ordinates and lamps; `side`^2 cells a shell."""
    n = ordinates.count
    rows = np.zeros(n + len(lamps), HopGridData.dtype)
    rows["mean_cosine"], rows["growth"] = 1.0, 1.0
    if n:
        _along(rows[:n], placement, placement.direction(ordinates.direction), cells)
        rows["mean_cosine"][:n] = ordinates.mean_cosine
    for row, lamp in zip(rows[n:].reshape(-1, 1), lamps, strict=True):
        position = placement.point(np.array(lamp.position))
        away = 0.5 * placement.extent - position
        distance = float(np.linalg.norm(away))
        if distance > FAR * 0.5 * float(np.linalg.norm(placement.extent)):
            _along(row, placement, away[None] / distance, cells)
        else:
            _around(row, radial_grid(placement.extent, position, side, shells))
    return rows


def _along(rows: Any, placement: MediumPlacement, directions: Any, cells: int) -> None:
    grids = ordinate_grids(placement.extent, directions, cells)
    for index, name in enumerate(("axis_x", "axis_y", "axis_z")):
        rows[name] = grids.axes[:, index]
    rows["corner"], rows["cell"], rows["count"] = grids.corner, grids.cell, grids.count


def _around(row: Any, grid: RadialGrid) -> None:
    row["corner"], row["radius"], row["growth"] = grid.centre, grid.radius, grid.growth
    row["count"], row["is_radial"] = (grid.side, grid.side, grid.shells), 1
