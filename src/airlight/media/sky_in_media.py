"""The light of the environment in media: for single scattering, and attenuated on surfaces.

For each cell and each of the directional lights that stand for the environment, shadow maps give
the visibility and media the transmittance. Fluence, net flux and a third band are stored, from
which marching computes single scattering; and the six irradiances of an ambient cube, for surfaces.
The third band is read where |g| is large: in dense media light comes from one side. The field is of
low frequency by construction: sharp shafts are those of directional lights.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ..fields import Frame, LatticeSource
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Texture
from ..gpu.rows import Table, table
from ..gpu.slots import FILTERED, image, sampler, texture, uniform
from ..lattice.placement import LatticeParams, Placement
from ..lattice.skylight import FACES
from ..lighting.sky import Sky
from ..maths.half import half_scale
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume
from ..surface.light_table import LightData, packed_lights
from ..surface.light_views import LightViewData
from ..surface.shadow import comparison_sampler
from .density_grids import ColumnPlan
from .gpu_media import GpuMedia
from .stale_cells import LISTED_CELLS, STALE_CELL_SLOTS, SkyLights, StaleCells

_MANY = 64
_LIMIT = "max-storage-textures-per-shader-stage"


def sky_points(lights: int) -> int:
    """At how many points of a cell each of a sky's `lights` is looked for: many are at others."""
    return 1 if lights >= _MANY else 2


class SkyInMediaParams(Struct):
    """How many lights of the sky there are, and how light is stored."""

    light_count = u32()
    points = u32("of a cell, at which each light is looked for")
    scale = f32("stored units per W m^-2")
    is_listed = u32("1: cells of the list alone")


_WRITTEN = {
    "sky_media_bands": ("red", "green", "blue", "mean"),
    "sky_media_sides": ("cube", "third"),
}
"""Images by the shader library that writes them: those that marching reads, and the rest."""


class _SkyInMedia(ComputePass):
    workgroup = (8, 8, 4)

    def __init__(self, gpu: Gpu, media: GpuMedia, written: Sequence[str]) -> None:
        """`written`: keys of _WRITTEN."""
        self.images = [name for library in written for name in _WRITTEN[library]]
        self.slots = (
            uniform("params", SkyInMediaParams),
            uniform("lattice", LatticeParams),
            table("lights", LightData),
            table("views", LightViewData),
            texture("depth", "2d-array", "depth"),
            sampler("compare", "comparison"),
            texture("lattice_walls", "3d"),
            *media.slots,
            *STALE_CELL_SLOTS,
            *(image(name, FILTERED, "3d") for name in self.images),
        )
        # Every light is met once, whichever bands of it are stored.
        stores = [f"    store_{library}(texel, light);\n" for library in written]
        super().__init__(
            gpu,
            generated=media.wgsl
            + LISTED_CELLS
            + "".join(f"//! use {library}\n" for library in written)
            + "fn store(texel: vec3u, light: SkyLight) {\n"
            + "".join(stores)
            + "}\n",
        )


class SkyInMedia:
    """The light that arrives in each cell of a lattice from an environment, through media."""

    def __init__(
        self,
        gpu: Gpu,
        scene: Scene,
        sky: Sky,
        placement: Placement,
        size: tuple[int, int, int] | None = None,
        *,
        columns: ColumnPlan,
        solved: Sequence[Medium | Volume] = (),
    ) -> None:
        """`solved` volumes and `columns` as for GpuMedia: their source includes single scattering.

        `size`: cells of the textures, which nested lattices share.
        """
        self.sky, self.placement = sky, placement
        self._levels: tuple[Placement, ...] = ()
        self.media = GpuMedia(
            # A rotated sky may have more lights.
            gpu,
            _under(scene, sky),
            light_count=max(len(sky.lights), sky.maps.layers),
            columns=columns,
            solved=solved,
        )
        self.scale = 1.0
        # Where a pass may write fewer textures than there are, two compute the same light.
        is_once = sum(map(len, _WRITTEN.values())) <= gpu.limits[_LIMIT]
        parts = [tuple(_WRITTEN)] if is_once else [(library,) for library in _WRITTEN]
        self._passes = [_SkyInMedia(gpu, self.media, part) for part in parts]
        # Room for all that may come: lights of a rotated sky, cells of every nested lattice.
        most = max(1, len(sky.lights), sky.maps.layers)
        self._lights = Table(gpu, "sky lights", LightData, most)
        self._compare = comparison_sampler(gpu)
        nx, ny, nz = size or placement.count
        self._make_textures(gpu, (nx, ny, nz))
        self._lit, self._media_version = b"", -1
        self._stale = StaleCells(gpu, nx * ny * nz)
        self.version = 0
        """Raised whenever cells were recomputed."""

    def _make_textures(self, gpu: Gpu, size: tuple[int, int, int]) -> None:
        nx, ny, nz = size

        def made(name: str, depth: int) -> Texture:
            label, full = f"sky in media, {name}", (nx, ny, depth)
            return Texture(gpu, label, full, FILTERED, dimension="3d", written=True)

        # Two bands of three channels, their means, the third band, and the cube of surfaces.
        self.red, self.green, self.blue = (made(name, nz) for name in ("red", "green", "blue"))
        self.cube = made("cube", FACES * nz)
        self.mean = made("mean", nz)
        self.third = made("third band", 4 * nz)

    def encode(
        self,
        commands: Commands,
        frame: Frame,
        walls: Texture,
        levels: Sequence[Placement] = (),
        *,
        shadows_changed: bool,
    ) -> None:
        """Bring the cells up to date, after `sky` and its maps.

        `levels`: the lattices that share the textures, the finest first; () for the only one.
        """
        self.media.update(commands, _under(frame.scene, self.sky), *frame.bounds)
        table = packed_lights(tuple(self.sky.lights))
        is_lit_alike = table.tobytes() == self._lit and not shadows_changed
        touched = self.media.touched_since(self._media_version) if is_lit_alike else None
        before, has_changed = self._levels, touched is None or len(touched) > 0
        self._levels = tuple(replace(x, fade=None) for x in levels or (self.placement,))
        # All cells of lattices that moved, or of all where light or shadows changed; else those
        # that light reaches through media that did.
        stale = [level for level in self._levels if has_changed or level not in before]
        self._media_version = self.media.version  # few are remembered, so each is seen
        if not stale:
            return
        self._lit = table.tobytes()
        self.version += 1
        # A scale that fits half floats: a power of two, so that it changes no bits.
        total = max((sum(x.irradiance[c] for x in self.sky.lights) for c in range(3)), default=0.0)
        self.scale = half_scale(total)
        self._lights.write(table)
        # Every light into each of these cells, shadowed by its map and attenuated by media.
        lights = SkyLights(self._lights, len(self.sky.lights), self.sky.maps, walls)
        for level in stale:
            self._stale.find(commands, touched if level in before else None, level, lights)
            for part in self._passes:
                part.dispatch(
                    commands,
                    level.count,
                    params=SkyInMediaParams(
                        light_count=lights.count,
                        points=sky_points(lights.count),
                        scale=self.scale,
                        is_listed=self._stale.is_listed,
                    ),
                    lattice=level.params(),
                    lights=self._lights,
                    views=self.sky.maps.views,
                    depth=self.sky.maps.depth,
                    compare=self._compare,
                    lattice_walls=walls,
                    **{name: getattr(self, name) for name in part.images},
                    **self.media.bound,
                    **self._stale.bound,
                )

    def source(self, walls: dict[str, Any], finer: tuple[Placement, ...] = ()) -> LatticeSource:
        """The field for marching; `walls` as Blockers.bound, `finer` as LatticeSource."""
        bound = {"sky_red": self.red, "sky_green": self.green, "sky_blue": self.blue}
        return LatticeSource(
            self.placement,
            bound | walls,
            1.0 / (4.0 * math.pi * self.scale),
            direct=3.0,
            finer=finer,
            mean=self.mean,
            third=self.third,
        )


def _under(scene: Scene, sky: Sky) -> Scene:
    """The scene lit by the sky's lights alone."""
    return dataclasses.replace(scene, lights=tuple(sky.lights))
