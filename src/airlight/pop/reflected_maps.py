"""The reflective shadow maps that virtual lights are taken from, as the air lets light to them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..lattice.blockers import Blockers
from ..lattice.placement import Placement
from ..lighting.direct import Direct
from ..lighting.lights import Lights
from ..lighting.sky import Sky
from ..march.air import Air
from ..march.dimmed import DimmedMaps, owners_of
from ..maths.transforms import F64
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views, view_count
from ..surface.reflective import ReflectiveShadowMaps
from .settings import PopSettings
from .virtual_lights import Reflected


class ReflectedMaps:
    """Maps of suns, lamps (dimmed by the air) and the sky (undimmed); `reflected` is all of it."""

    def __init__(
        self, gpu: Gpu, scene: Scene, lights: Lights, sky: Sky, air: Air, *, blockers: Blockers,
        placement: Placement, count: int, resolution: int,
    ) -> None:  # fmt: skip
        """`count` virtual lights; `resolution`: side of a sun's map, twice a lamp's, px."""
        self._lights, self._air = lights, air
        groups = _by_kind(scene.lights)
        sides, names = (resolution, max(8, resolution // 2)), ("suns", "lamps")
        self._maps = [
            ReflectiveShadowMaps(gpu, name, side, sum(view_count(x) for x in group))
            for name, side, group in zip(names, sides, groups, strict=True)
        ]
        self._dimmed = [
            DimmedMaps(gpu, maps, air, owners_of(scene.lights, group))
            for maps, group in zip(self._maps, groups, strict=True)
        ]
        self._air_version = -1
        self.reflected = Reflected((*self._dimmed, sky.maps), blockers, placement, count)

    def encode(
        self, commands: Commands, meshes: GpuScene, lights: Sequence[Light], low: F64, high: F64
    ) -> None:
        """Draw and dim what changed; the air is up to date. low..high: the scene, m."""
        drawn = False
        for group, maps in zip(_by_kind(lights), self._maps, strict=True):
            if maps.layers:
                views = light_views(group, np.asarray(low), np.asarray(high), maps.resolution)
                drawn = maps.encode(commands, meshes, group, views) or drawn
        if drawn or self._air.version != self._air_version:
            self._air_version = self._air.version
            self.reflected.version += 1
            for maps in self._dimmed:
                maps.dim(commands, self._lights.table)

    def release(self) -> None:
        """Give the memory back."""
        for maps in (*self._dimmed, *self._maps):
            maps.release()


def reflected_maps(
    scene: Scene, settings: PopSettings, surfaces: Direct, air: Air
) -> ReflectedMaps | None:
    """What a technique's media take virtual lights from, where they are to have any."""
    if not scene.meshes or not settings.virtual_lights:
        return None
    return ReflectedMaps(
        surfaces.gpu, scene, surfaces.lights, surfaces.sky, air, blockers=surfaces.blockers,
        placement=surfaces.placement, count=settings.virtual_lights,
        resolution=settings.virtual_resolution,
    )  # fmt: skip


def _by_kind(lights: Sequence[Light]) -> tuple[list[Light], list[Light]]:
    suns: list[Light] = [x for x in lights if isinstance(x, DirectionalLight)]
    return suns, [x for x in lights if not isinstance(x, DirectionalLight)]
