"""The final gather in the air: what arrives in a lattice's cells, found by rays.

Cells of a lattice know the light that came to them through the faces between; a window of two
cells is nearly shut to it, and a wall between cells is no sharper than they are. Rays from the
middles of the cells find instead what surfaces and the air beyond send there, as the rays of pixels
do. Half of them go into all directions alike, half where the media's phase function towards the eye
is large; what it scatters of their radiance is kept, and the mean for the rays of the next sample.
The first sample's rays meet the light in air that the lattice solved, later ones' what earlier
samples found.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..fields import AirLight, LatticeSource
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3f
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import FILTERED, image, storage, texture, uniform
from ..lattice.placement import LatticeParams, Placement
from ..lighting.view import View
from ..media.gpu_media import GpuMedia

# Texels in a row of the images whose points are cells.
_WIDTH = 1024
CellLight = tuple[LatticeSource, AirLight]
"""Light that is scattered towards the eye, and what rays meet."""


class CellPointParams(Struct):
    """Where a lattice's cells begin among the points, and the width of their texture."""

    first = u32("points")
    width = u32("texels")
    eye = vec3f("world, m")
    ahead = vec3f("unit length, where it looks")


class CellSumParams(Struct):
    """Where a lattice's cells begin, which rays they sent, and the scale of their sums."""

    first = u32("points")
    width = u32("texels")
    points = u32("from one ray of a point to its next")
    rays = u32("of a point")
    first_ray = u32()
    scale = f32("stored units per W m^-2 sr^-1, over the number of rays")
    weight = f32("of this sample in what the next one's rays meet")


class CellAirParams(Struct):
    """Where a lattice's cells begin among the points, and the scale of their light."""

    first = u32("points")
    scale = f32("stored units per W m^-2 sr^-1")


class _CellPoints(ComputePass):
    workgroup = (32, 8, 1)

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", CellPointParams),
            uniform("lattice", LatticeParams),
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
        storage("paths", "vec4f"),
        texture("axes", "2d", "unfilterable-float"),
        texture("cosines", "2d", "unfilterable-float"),
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
        texture("unscattered", "3d", "unfilterable-float"),
        image("air", FILTERED, "3d"),
    )
    workgroup = (32, 8, 1)
    file = "cell_air.wgsl"


class CellPoints:
    """The middles of all cells of nested lattices, as `points.Points` has those of an image.

    `normals`: in place of a surface's the direction to the eye, with the mean of the three
    `cosines`, by which the media of the cell scatter.
    """

    def __init__(self, gpu: Gpu, cells: int, media: GpuMedia) -> None:
        """For so many `cells`, of all lattices together, in `media`."""
        # Cells are points of an image, so that their rays are traced like those of pixels.
        self.reduced = (_WIDTH, -(-cells // _WIDTH))
        self.places = Texture(gpu, "cell places", self.reduced, "rgba32float", written=True)
        self.normals, self.cosines = (
            Texture(gpu, f"cell {name}", self.reduced, "rgba16float", written=True)
            for name in ("axes", "mean cosines")
        )
        self._pass, self._media = _CellPoints(gpu, media), media

    @property
    def count(self) -> int:
        """How many there are room for: whole rows of texels."""
        return self.reduced[0] * self.reduced[1]

    def encode(
        self, commands: Commands, view: View, placements: tuple[Placement, ...], walls: Texture
    ) -> None:
        """Take the middles of the cells of these lattices; `walls` as of their blockers."""
        # Directions lead to a point behind the eye, so that the cell around it is seen, too.
        ahead = np.subtract(view.camera.target, view.camera.position)
        ahead = ahead / max(float(np.linalg.norm(ahead)), 1e-20)
        # Cells of all lattices are numbered in one row, and rays of all of them traced at once.
        for first, placement in _numbered(placements):
            self._pass.dispatch(
                commands,
                placement.count,
                params=CellPointParams(
                    first=first, width=_WIDTH, eye=view.eye, ahead=ahead.tolist()
                ),
                lattice=placement.params(),
                lattice_walls=walls,
                **self._media.medium_bound,
                places=self.places,
                axes=self.normals,
                cosines=self.cosines,
            )


class CellSums:
    """The radiance that arrives in cells, in textures such as `LatticeSource` binds."""

    def __init__(self, gpu: Gpu, points: CellPoints, size: tuple[int, int, int]) -> None:
        """`size` in cells: of the textures that lattices share."""
        # Light towards the eye and light that rays meet, in textures of all lattices.
        self._inscattered, self._air = (
            Texture(gpu, name, size, FILTERED, dimension="3d", written=True)
            for name in ("gathered in-scattering", "gathered light in air")
        )
        self._before = Buffer(gpu, "light in air before", 16 * points.count)
        self._points, self._pass, self._next = points, _CellSums(gpu), _CellAir(gpu)

    def encode(
        self, commands: Commands, paths: Buffer, numbers: range, light: CellLight, number: int
    ) -> CellLight:
        """`light` with that of the `paths` of the rays of these `numbers`.

        `number`: how many samples of the same light there were before.
        """
        scattered, air = light
        largest, points = scattered.placement.cell, self._points.count
        for first, placement in _numbered(scattered.levels):
            # Marching takes textures to hold the power of cells: of smaller ones, less.
            share = (placement.cell / largest) ** 2
            self._pass.dispatch(
                commands,
                placement.count,
                params=CellSumParams(
                    first=first,
                    width=_WIDTH,
                    points=points,
                    rays=len(numbers),
                    first_ray=numbers.start,
                    scale=share / (scattered.scale * len(numbers)),
                    weight=2.0 / (number + 2.0),
                ),
                lattice=placement.params(),
                paths=paths,
                axes=self._points.normals,
                cosines=self._points.cosines,
                inscattered=self._inscattered,
                before=self._before,
            )
            # What rays of the next sample meet in the air: this, and the unscattered light.
            self._next.dispatch(
                commands,
                placement.count,
                params=CellAirParams(first=first, scale=share / air.mean.scale),
                lattice=placement.params(),
                before=self._before,
                unscattered=air.unscattered,
                air=self._air,
            )
        # The fields of before, with these textures in place of theirs.
        in_air: dict[str, Any] = {f"lattice_{name}": self._air for name in ("red", "green", "blue")}
        met = replace(air.mean, bound=air.mean.bound | in_air, mean=self._air)
        seen = replace(scattered, mean=self._inscattered, is_inscattered=True)
        return seen, replace(air, mean=met)


def _numbered(placements: tuple[Placement, ...]) -> list[tuple[int, Placement]]:
    """Each lattice with the number of its first cell among those of all."""
    firsts = [sum(p.cells for p in placements[:i]) for i in range(len(placements))]
    return list(zip(firsts, placements, strict=True))
