"""The reflective shadow maps that virtual lights are taken from, as media let light to them."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...lighting.kit import Kit
from ...maths.transforms import F64
from ...media.attenuated_maps import AttenuatedMaps
from ...media.gpu_media import GpuMedia
from ...scene.scene import Scene
from ...surface.light_maps import LightMaps
from ..settings import PopSettings
from .lights import Reflected


class ReflectedMaps:
    """Maps of the scene's lights, attenuated by media, and of the sky; `reflected` is all of it."""

    def __init__(self, kit: Kit, air: GpuMedia, settings: PopSettings) -> None:
        """For as many virtual lights, and maps as large, as `settings` say."""
        self._kit, self._air = kit, air
        lights = kit.context.scene.lights
        self._maps = LightMaps(kit.gpu, lights, settings.virtual_resolution)
        self._dimmed = [
            AttenuatedMaps(kit.gpu, maps, air, owners)
            for maps, owners in zip(self._maps.groups, self._maps.owners, strict=True)
        ]
        self._air_version = -1
        self.reflected = Reflected(
            (*self._dimmed, kit.sky.maps), kit.blockers, kit.placement, settings.virtual_lights
        )

    def encode(self, commands: Commands, scene: Scene, low: F64, high: F64) -> None:
        """Draw and attenuate what changed; media are up to date. low..high: the scene, m."""
        drawn = self._maps.encode(commands, self._kit.meshes, scene.lights, low, high)
        if drawn or self._air.version != self._air_version:
            self._air_version = self._air.version
            self.reflected.version += 1
            for maps in self._dimmed:
                maps.dim(commands, self._kit.lights.table)


def reflected_maps(kit: Kit, air: GpuMedia, settings: PopSettings) -> ReflectedMaps | None:
    """What a technique's media take virtual lights from, where they are to have any."""
    has_any = bool(kit.context.scene.meshes and settings.virtual_lights)
    return ReflectedMaps(kit, air, settings) if has_any else None
