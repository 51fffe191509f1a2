"""The grids in which light propagates, one per ordinate and local light, and the medium in them.

See `maths.ordinate_grid` and `maths.radial_grid`. All have room for the same number of cells, so
that one dispatch goes through all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, f32, u32, vec3f, vec3u
from ...gpu.memory import Buffer, buffer_of
from ...gpu.slots import sampler, storage, texture, uniform
from ...maths.octahedron import octahedron_cell_solid_angles
from ...maths.ordinate_grid import ordinate_grids
from ...maths.ordinates import Ordinates
from ...maths.radial_grid import RadialGrid, radial_grid, shell_growth
from ..light.table import LocalLight
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams, MediumPlacement
from ..settings import PopSettings

FAR = 2.0
"""A local light so many half diagonals from the middle of a medium gets a parallel grid: seen from
there, the cells of a shell are wider than the medium."""
# Of sums that atomics add up, so that their bits do not depend on the order.
FIXED_POINT_BITS = 30
GROUP = 64
"""Cells of a workgroup."""
MOST_GROUPS = 32768
"""Workgroups of a dispatch; a device takes 65535. Where cells are more, each takes several."""


class GridData(Struct):
    """One grid in the frame of the medium: parallel to an ordinate, or shells around a light."""

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
    fixed_scale = f32("in the first row: integers per W of residuum around local lights")


class GridParams(Struct):
    """One dispatch over all grids."""

    eye = vec3f("m, in the frame of the medium")
    capacity = u32("cells that each grid has room for")
    grids = u32("how many there are")
    first_row = u32("the first grid's light among the ordinates")
    first_local = u32("grid of the first local light")
    columns = u32("of a grid that begin together")
    is_paper = u32("1: Elek2014 as printed")
    is_last = u32("1: all light that still propagates joins the residuum")
    is_added = u32("1: added to the deposits of beams")


@dataclass(frozen=True, eq=False)
class GridLights:
    """The lights that propagate in grids: rows of an ordinate table from `first_row` on.

    `scale`, W m^-2, as in the table. The last `virtual` lights are virtual point lights, whose
    grids are placed on the device.
    """

    ordinates: Ordinates
    local: Sequence[LocalLight]
    scale: float
    virtual: int = 0
    first_row: int = 0


_CONSTANTS = f"const GROUP = {GROUP}u;\nconst MOST_GROUPS = {MOST_GROUPS}u;\n"


class _Fill(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("hops", GridParams),
        storage("grids", GridData),
        storage("solid_angles", "f32"),
        texture("fine", "3d"),
        sampler("linear_clamp"),
        storage("hop_rho", "f32", "read_write"),
        storage("listed", "atomic<u32>", "read_write"),
        storage("groups", "atomic<u32>", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "density.wgsl"


class Grids:
    """`rows`, GridData of every ordinate, local light and virtual point light, in this order.

    `density`: f32 [grid][z][y][x]. `listed`: how many cells light may propagate from, then grid *
    `capacity` + cell of each in any order; `groups` of `GROUP` of them, to dispatch. Most cells
    around a light beside the medium are not listed.
    """

    def __init__(
        self, medium: GridMedium, settings: PopSettings, most: int, *, is_paper: bool = False
    ) -> None:
        """At most `most` grids of about `settings.grid`^3 cells; `is_paper`: as printed."""
        gpu, side = medium.gpu, settings.grid
        self._medium, self._prefilter, self._is_paper = medium, settings.prefilter, is_paper
        # The cells of a shell are those of an octahedral map, whose side is even.
        self.side = side + side % 2
        self.shells = side
        self.capacity = grid_capacity(side)
        # Where the grids are, the density in their cells, and which cells light passes.
        self.rows = Buffer(gpu, "grids", GridData.dtype.itemsize * most)
        self.density = Buffer(gpu, "density of grids", 4 * self.capacity * most)
        self.listed = Buffer(gpu, "cells of grids", 4 * (1 + self.capacity * most))
        self.groups = Buffer(gpu, "groups of grid cells", 16, indirect=True)
        angles = octahedron_cell_solid_angles(self.side).astype(np.float32)
        self.solid_angles = buffer_of(gpu, "solid angles", angles)
        self._fill = _Fill(gpu, generated=_CONSTANTS)
        self.columns = 1
        self.first_row = self.ordinates = self.local = self.virtual = 0
        self.local_power = 0.0

    @property
    def growth(self) -> float:
        """The growth of shells."""
        return shell_growth(self.side)

    @property
    def count(self) -> int:
        """How many grids there are."""
        return self.ordinates + self.local + self.virtual

    @property
    def is_blurred(self) -> bool:
        """Whether each lobe is at least as wide as the part of the sky that it stands for."""
        return self._prefilter

    def write(self, lights: GridLights) -> None:
        """Place the grids of `lights` but the virtual ones, and upload them."""
        local, virtual = lights.local, lights.virtual
        self.first_row = lights.first_row
        self.ordinates, self.local, self.virtual = lights.ordinates.count, len(local), virtual
        # Rows of the scene's own lights; the device adds those of virtual ones (`virtual.grids`).
        rows = grid_rows(lights, self._medium.placement, self.capacity, self.side, self.shells)
        if not self._prefilter:
            rows["mean_cosine"] = 1.0
        # Columns that begin together are as many as the widest grid has.
        least = self.side**2 if virtual else 1
        self.columns = int(np.max(rows["count"][:, 0] * rows["count"][:, 1], initial=least))
        # The residuum of all local lights fits into the integers that it is summed in.
        self.local_power = sum(4.0 * np.pi * max(x.intensity) / lights.scale for x in local)
        power = self.local_power if self.local_power > 0.0 else 1.0
        rows["fixed_scale"][:1] = float(2**FIXED_POINT_BITS) / power
        if len(rows):
            self.rows.write(rows)

    def params(self, eye: Any, *, is_last: bool = False, is_added: bool = False) -> GridParams:
        """For an eye (3,), m in the frame of the medium."""
        return GridParams(
            eye=eye,
            capacity=self.capacity,
            grids=self.count,
            first_row=self.first_row,
            first_local=self.ordinates,
            columns=self.columns,
            is_paper=int(self._is_paper),
            is_last=int(is_last),
            is_added=int(is_added),
        )

    @property
    def bound(self) -> dict[str, Buffer]:
        """What passes over the grids bind, by slot name."""
        return {
            "grids": self.rows,
            "solid_angles": self.solid_angles,
            "hop_rho": self.density,
        }

    def encode(self, commands: Commands, params: MediumParams) -> None:
        """Fill `density`, and list the cells."""
        # Cells are listed by atomic counters, which start at 0.
        for counter in (self.listed, self.groups):
            commands.encoder.clear_buffer(counter.handle)
        density = self._medium.density
        self._fill.dispatch(
            commands,
            (self.capacity, max(1, self.count)),
            params=params,
            hops=self.params((0.0, 0.0, 0.0)),
            **self.bound,
            fine=density.fine,
            linear_clamp=density.linear,
            listed=self.listed,
            groups=self.groups,
        )


def grid_capacity(side: int) -> int:
    """Cells that each grid of about `side`^3 has room for: shells have an even number."""
    return (side + side % 2) ** 2 * side


def grid_rows(
    lights: GridLights, placement: MediumPlacement, cells: int, side: int, shells: int
) -> np.ndarray[Any, np.dtype[Any]]:
    """`GridData` of ordinates and local lights: of at most `cells`, or `side`^2 of each shell."""
    n = lights.ordinates.count
    rows = np.zeros(n + len(lights.local), GridData.dtype)
    rows["mean_cosine"], rows["growth"] = 1.0, 1.0
    # A parallel grid along each ordinate.
    if n:
        _along(rows[:n], placement, placement.direction(lights.ordinates.direction), cells)
        rows["mean_cosine"][:n] = lights.ordinates.mean_cosine
    # Shells around each local light, unless it is far away.
    for row, light in zip(rows[n:].reshape(-1, 1), lights.local, strict=True):
        position = placement.point(np.array(light.position))
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
