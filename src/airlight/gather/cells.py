"""The final gather in the air: what arrives in a lattice's cells, found by rays.

Cells of a lattice know the light that came to them through the faces between; a window of two cells
is nearly shut to it, and a wall between cells is no sharper than they are. Rays from the middles of
the cells find instead what surfaces and the air beyond send there, as the rays of pixels do. Half
of them go into all directions alike, half where the media's phase function towards the eye is
large, and some of both towards what lights shine on, where that is small; what it scatters of their
radiance is kept, and the mean for the rays of the next sample. The first sample's rays meet the
light in air that the lattice solved, later ones' what earlier samples found. Cells that the view
does not read send rays in some of the samples; until then they have what the lattice solved.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..fields import AirLight, InScattered, LatticeSource
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import FILTERED, image, storage, texture, uniform
from ..lattice.placement import LatticeParams, Placement
from ..lighting.view import View
from ..media.gpu_media import GpuMedia
from .guide import LightPatch
from .seen_cells import NO_POINT, SeenCells

# Texels in a row of the images whose points are cells.
_WIDTH = 1024
CellLight = tuple[LatticeSource, AirLight]
"""Light that is scattered towards the eye, and what rays meet."""


class CellPointParams(Struct):
    """Which points are cells of a lattice, and where these begin among the cells of all."""

    first = u32("cell")
    begin = u32("point")
    end = u32("point")
    width = u32("texels")
    eye = vec3f("world, m")
    ahead = vec3f("unit length, where it looks")


class CellSumParams(Struct):
    """Where a lattice's cells begin, which rays they sent, and the scale of their sums."""

    first = u32("cell")
    width = u32("texels")
    points = u32("from one ray of a point to its next")
    rays = u32("of a point")
    first_ray = u32()
    scale = f32("stored units per W m^-2 sr^-1")
    solved_scale = f32("W m^-2 sr^-1 per stored unit of what the lattice solved")
    number = u32("how many samples of the same light there were before")


class CellAirParams(Struct):
    """Where a lattice's cells begin, and the scale of their light."""

    first = u32("cell")
    scale = f32("stored units per W m^-2 sr^-1")


class _CellPoints(ComputePass):
    workgroup = (32, 8, 1)

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (
            uniform("params", CellPointParams),
            uniform("lattice", LatticeParams),
            storage("seen", "u32"),
            texture("lattice_walls", "3d"),
            *media.medium_slots,
            image("places", "rgba32float"),
            image("axes", "rgba16float"),
            image("cosines", "rgba16float"),
        )
        super().__init__(gpu, generated=media.medium_wgsl)

    file = "cell_points.wgsl"


class _CellSums(ComputePass):
    slots = (
        uniform("params", CellSumParams),
        uniform("lattice", LatticeParams),
        storage("points_of_cells", "vec2u"),
        storage("paths", "vec4f"),
        storage("lit_patches", LightPatch),
        texture("places", "2d", "unfilterable-float"),
        texture("axes", "2d", "unfilterable-float"),
        texture("cosines", "2d", "unfilterable-float"),
        texture("solved", "3d", "unfilterable-float"),
        texture("straight", "3d", "unfilterable-float"),
        image("inscattered", FILTERED, "3d"),
        storage("before", "vec4f", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "cell_sums.wgsl"


class _CellAir(ComputePass):
    slots = (
        uniform("params", CellAirParams),
        uniform("lattice", LatticeParams),
        storage("before", "vec4f"),
        texture("straight", "3d", "unfilterable-float"),
        image("air", FILTERED, "3d"),
        image("scattered_along", FILTERED, "3d"),
    )
    workgroup = (32, 8, 1)
    file = "cell_air.wgsl"


class CellPoints:
    """The middles of cells that send rays: `starts`, as `points.Points` has those of an image.

    `normals`: in place of a surface's the direction to the eye, with the mean of the three
    `cosines`, by which the media of the cell scatter.
    """

    def __init__(self, gpu: Gpu, rows: int, media: GpuMedia) -> None:
        """For so many `rows` of cells, of all lattices together, in `media`."""
        # Cells are points of an image, so that their rays are traced like those of pixels.
        self.reduced = (_WIDTH, rows)
        self.starts = Texture(gpu, "cell places", self.reduced, "rgba32float", written=True)
        self.normals, self.cosines = (
            Texture(gpu, f"cell {name}", self.reduced, "rgba16float", written=True)
            for name in ("axes", "mean cosines")
        )
        self._seen = Buffer(gpu, "seen cells", 4 * self.count)
        self._pass, self._media = _CellPoints(gpu, media), media
        self.ahead = np.zeros(3)
        """Unit length, where the eye looks."""

    @property
    def count(self) -> int:
        """How many there are room for: whole rows of texels."""
        return self.reduced[0] * self.reduced[1]

    def write(self, seen: SeenCells) -> None:
        """Take these cells, for which there is room."""
        listed = np.full(self.count, NO_POINT, np.uint32)
        listed[: seen.cells.size] = seen.cells
        self._seen.write(listed)

    def encode(
        self,
        commands: Commands,
        view: View,
        placements: tuple[Placement, ...],
        seen: SeenCells,
        walls: Texture,
    ) -> None:
        """Take the middles of the cells that were written; `walls` as of the blockers."""
        # Directions lead to a point behind the eye, so that the cell around it is seen, too.
        ahead = np.subtract(view.camera.target, view.camera.position)
        self.ahead = ahead / max(float(np.linalg.norm(ahead)), 1e-20)
        # Points of all lattices lie in one row; the last's go on to the end of its texels.
        ends = [begin for _, begin in seen.firsts[1:]] + [self.count]
        for placement, (first, begin), end in zip(placements, seen.firsts, ends, strict=True):
            if begin == end:
                continue
            self._pass.dispatch(
                commands,
                (_WIDTH, -(-(end - begin) // _WIDTH)),
                params=CellPointParams(
                    first=first,
                    begin=begin,
                    end=end,
                    width=_WIDTH,
                    eye=view.eye,
                    ahead=self.ahead.tolist(),
                ),
                lattice=placement.params(),
                seen=self._seen,
                lattice_walls=walls,
                **self._media.medium_bound,
                places=self.starts,
                axes=self.normals,
                cosines=self.cosines,
            )


def rows_of(cells: int) -> int:
    """Rows of texels for so many: a few more than they need, so that few sizes differ."""
    rows = max(1, -(-cells // _WIDTH))
    step = 1 << max(0, rows.bit_length() - 3)
    return -(-rows // step) * step


class CellSums:
    """The radiance that arrives in cells, in textures such as `LatticeSource` binds."""

    def __init__(self, gpu: Gpu, cells: int, size: tuple[int, int, int]) -> None:
        """Of so many `cells` of all lattices; `size` in cells: of the textures that these share."""
        # Light towards the eye and light that rays meet, in textures of all lattices.
        self._inscattered, self._air, self._along = (
            Texture(gpu, name, size, FILTERED, dimension="3d", written=True)
            for name in ("gathered in-scattering", "gathered light in air", "where that goes")
        )
        # Of each cell mean radiance and how many samples found it, and where it goes.
        self._before = Buffer(gpu, "light in air before", 32 * cells)
        self._points_of_cells = Buffer(gpu, "points of cells", 8 * cells)
        self._cells, self._next = cells, _CellAir(gpu)
        self._pass = _CellSums(gpu, constants={"FROM_AIR": 1.0})

    def write(self, seen: SeenCells) -> None:
        """Take these cells as those that send rays."""
        self._points_of_cells.write(seen.points(self._cells))

    def encode(
        self,
        commands: Commands,
        points: CellPoints,
        paths: Buffer,
        numbers: range,
        light: CellLight,
        number: int,
        patches: Buffer,
    ) -> CellLight:
        """`light` with that of the `paths` of the rays of these `numbers` from `points`.

        `number`: how many samples of the same light there were before. `patches`: that led rays.
        """
        scattered, air = light
        largest = scattered.placement.cell
        assert air.mean.mean is not None
        for first, placement in _numbered(scattered.levels):
            # Marching takes textures to hold the power of cells: of smaller ones, less.
            share = (placement.cell / largest) ** 2
            self._pass.dispatch(
                commands,
                placement.count,
                params=CellSumParams(
                    first=first,
                    width=_WIDTH,
                    points=points.count,
                    rays=len(numbers),
                    first_ray=numbers.start,
                    scale=share / scattered.scale,
                    solved_scale=air.mean.scale / share,
                    number=number,
                ),
                lattice=placement.params(),
                points_of_cells=self._points_of_cells,
                paths=paths,
                lit_patches=patches,
                places=points.starts,
                axes=points.normals,
                cosines=points.cosines,
                solved=air.mean.mean,
                straight=air.lobes.straight,
                inscattered=self._inscattered,
                before=self._before,
            )
        met = self._met(commands, air, scattered.levels)
        # Nothing of it is beams, or comes through reduced media.
        seen = replace(
            scattered,
            mean=self._inscattered,
            inscattered=InScattered(self._along, points.ahead),
            forward=None,
            is_reduced_medium=False,
        )
        return seen, met

    def _met(
        self, commands: Commands, air: AirLight, placements: tuple[Placement, ...]
    ) -> AirLight:
        """What rays of the next sample meet in the air: this light, and `air` unscattered."""
        largest = placements[-1].cell
        for first, placement in _numbered(placements):
            share = (placement.cell / largest) ** 2
            self._next.dispatch(
                commands,
                placement.count,
                params=CellAirParams(first=first, scale=share / air.mean.scale),
                lattice=placement.params(),
                before=self._before,
                straight=air.lobes.straight,
                air=self._air,
                scattered_along=self._along,
            )
        # The fields of before, with these textures in place of theirs.
        in_air: dict[str, Any] = {f"lattice_{name}": self._air for name in ("red", "green", "blue")}
        met = replace(air.mean, bound=air.mean.bound | in_air, mean=self._air)
        return replace(air, mean=met, lobes=replace(air.lobes, scattered_along=self._along))


def _numbered(placements: tuple[Placement, ...]) -> list[tuple[int, Placement]]:
    """Each lattice with the number of its first cell among those of all."""
    firsts = [sum(p.cells for p in placements[:i]) for i in range(len(placements))]
    return list(zip(firsts, placements, strict=True))
