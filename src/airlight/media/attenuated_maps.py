"""Reflective shadow maps as the air lets their lights through to them.

The maps themselves know no air; a copy of their flux is made that does, anew in every frame.
Elek2014 section 6 samples them by such attenuated flux.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer, Texture, buffer_of
from ..gpu.slots import image, storage, texture, uniform
from ..surface.light_table import LightData
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps
from .gpu_media import GpuMedia


class AttenuationParams(Struct):
    """The size of the maps."""

    resolution = u32("texels")
    layers = u32()


class _Attenuate(ComputePass):
    workgroup = (16, 16, 1)
    file = "attenuated_maps.wgsl"

    def __init__(self, gpu: Gpu, air: GpuMedia) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", AttenuationParams),
            storage("views", LightViewData),
            storage("lights", LightData),
            storage("owners", "u32"),
            texture("depth", "2d-array", "depth"),
            texture("flux", "2d-array", "unfilterable-float"),
            image("dimmed", "rgba16float", "2d-array"),
            *air.slots,
        )
        super().__init__(gpu, generated=air.wgsl)


class _AttenuateSky(ComputePass):
    workgroup = (16, 16, 1)
    file = "attenuated_maps_sky.wgsl"

    def __init__(self, gpu: Gpu, air: GpuMedia) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", AttenuationParams),
            storage("views", LightViewData),
            texture("depth", "2d-array", "depth"),
            texture("flux", "2d-array", "unfilterable-float"),
            image("dimmed", "rgba16float", "2d-array"),
            *air.medium_slots,
        )
        super().__init__(gpu, generated=air.medium_wgsl)


class AttenuatedMaps(ReflectiveShadowMaps):
    """`of`, their flux attenuated; drawn by `of`, read like it."""

    def __init__(
        self, gpu: Gpu, of: ReflectiveShadowMaps, air: GpuMedia, owners: Sequence[int]
    ) -> None:
        """`owners`: each layer's row among the scene's lights."""
        self.resolution, self.layers, self.views = of.resolution, of.layers, of.views
        self.depth, self.normal = of.depth, of.normal
        self._from, self._air = of, air
        size = (of.resolution, of.resolution, of.layers) if of.layers else (1, 1, 1)
        self.flux = Texture(gpu, "dimmed flux", size, "rgba16float", dimension="2d-array",
                            written=True)  # fmt: skip
        self._owners = buffer_of(gpu, "map owners", np.array(list(owners) or [0], np.uint32))
        self._dim = _Attenuate(gpu, air)

    def dim(self, commands: Commands, lights: Buffer) -> None:
        """Take the maps and the air as they are; `lights`: the scene's table."""
        if not self.layers:
            return
        self._dim.dispatch(
            commands, (self.resolution, self.resolution, self.layers),
            params=AttenuationParams(resolution=self.resolution, layers=self.layers),
            views=self.views,
            lights=lights, owners=self._owners, depth=self.depth, flux=self._from.flux,
            dimmed=self.flux, **self._air.bound,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back; the maps are their owner's."""
        self.flux.release()
        self._owners.release()


class AttenuatedSkyMaps(ReflectiveShadowMaps):
    """The maps of the sky's lights, their flux attenuated; drawn by `of`, read like it."""

    def __init__(self, gpu: Gpu, of: ReflectiveShadowMaps, air: GpuMedia) -> None:
        self.resolution, self.layers, self.views = of.resolution, of.layers, of.views
        self.depth, self.normal = of.depth, of.normal
        self._from, self._air = of, air
        size = (of.resolution, of.resolution, of.layers) if of.layers else (1, 1, 1)
        self.flux = Texture(gpu, "dimmed flux of the sky", size, "rgba16float",
                            dimension="2d-array", written=True)  # fmt: skip
        self._dim = _AttenuateSky(gpu, air)

    def dim(self, commands: Commands) -> None:
        """Take the maps and the air as they are."""
        if self.layers:
            self._dim.dispatch(
                commands, (self.resolution, self.resolution, self.layers),
                params=AttenuationParams(resolution=self.resolution, layers=self.layers),
                views=self.views,
                depth=self.depth, flux=self._from.flux, dimmed=self.flux,
                **self._air.medium_bound,
            )  # fmt: skip

    def release(self) -> None:
        """Give the memory back; the maps are their owner's."""
        self.flux.release()
