"""Reflective shadow maps attenuated by participating media.

The maps themselves know no media; a copy of their flux does, which their users bring up to date.
Elek2014 section 6 samples the maps by such attenuated flux.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Texture, buffer_of
from ..gpu.rows import Table, table
from ..gpu.slots import Slot, image, storage, texture, uniform
from ..surface.light_table import LightData
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps
from .gpu_media import GpuMedia


class AttenuationParams(Struct):
    """The size of the maps, and where the sky's light begins."""

    resolution = u32("texels")
    layers = u32()
    beyond = f32("m, how far before the sky's maps media may lie")


class _Attenuate(ComputePass):
    """Through media by their columns towards each light; `own` slots and WGSL are the media's."""

    workgroup = (16, 16, 1)
    file = "attenuated_maps.wgsl"

    def __init__(self, gpu: Gpu, own: tuple[Slot, ...], wgsl: str) -> None:
        self.slots = (
            uniform("params", AttenuationParams),
            table("views", LightViewData),
            texture("depth", "2d-array", "depth"),
            texture("flux", "2d-array", "unfilterable-float"),
            image("attenuated", "rgba16float", "2d-array"),
            *own,
        )
        super().__init__(gpu, generated=wgsl)


class _AttenuateSky(_Attenuate):
    """The sky's maps are parallel: along each of them media are marched, without columns."""

    file = "attenuated_maps_sky.wgsl"


class _Attenuated(ReflectiveShadowMaps):
    """`of`, their flux attenuated; drawn by `of`, read like it."""

    def __init__(
        self, gpu: Gpu, name: str, of: ReflectiveShadowMaps, attenuate: ComputePass
    ) -> None:
        # What `of` draws is shared; the flux alone has a texture of its own.
        self.resolution, self.layers, self.views = of.resolution, of.layers, of.views
        self.block = of.block
        self.depth, self.normal = of.depth, of.normal
        self._from, self._attenuate = of, attenuate
        # A map without layers still has a texture, because slots want one.
        size = (of.resolution, of.resolution, of.layers) if of.layers else (1, 1, 1)
        self.flux = Texture(gpu, name, size, "rgba16float", dimension="2d-array", written=True)

    def _copy(self, commands: Commands, *, beyond: float = 0.0, **bound: Any) -> None:
        """Attenuate the flux of each texel; `bound`: what the pass reads besides the maps."""
        # The copy keeps the maps' views and depth, so that it can stand in for them wherever flux
        # is read.
        if self.layers:
            self._attenuate.dispatch(
                commands,
                (self.resolution, self.resolution, self.layers),
                params=AttenuationParams(
                    resolution=self.resolution, layers=self.layers, beyond=beyond
                ),
                views=self.views,
                depth=self.depth,
                flux=self._from.flux,
                attenuated=self.flux,
                **bound,
            )


class AttenuatedMaps(_Attenuated):
    """The maps of the scene's lights, attenuated by media from each light to the texel."""

    def __init__(
        self, gpu: Gpu, of: ReflectiveShadowMaps, media: GpuMedia, owners: Sequence[int]
    ) -> None:
        """`owners`: each layer's row among the scene's lights."""
        own = (table("lights", LightData), storage("owners", "u32"), *media.slots)
        super().__init__(gpu, "attenuated flux", of, _Attenuate(gpu, own, media.wgsl))
        self._media = media
        self._owners = buffer_of(gpu, "map owners", np.array(list(owners) or [0], np.uint32))

    def attenuate(self, commands: Commands, lights: Table) -> None:
        """Take the maps and the media as they are; `lights`: the scene's table."""
        self._copy(commands, lights=lights, owners=self._owners, **self._media.bound)


class AttenuatedSkyMaps(_Attenuated):
    """The maps of the sky's lights, attenuated by media along the maps' depth."""

    def __init__(self, gpu: Gpu, of: ReflectiveShadowMaps, media: GpuMedia) -> None:
        attenuate = _AttenuateSky(gpu, media.medium_slots, media.medium_wgsl)
        super().__init__(gpu, "attenuated flux of the sky", of, attenuate)
        self._media = media

    def attenuate(self, commands: Commands, beyond: float = 0.0) -> None:
        """Take the maps and the media as they are, which may lie `beyond`, m, before the maps."""
        self._copy(commands, beyond=beyond, **self._media.medium_bound)
