"""The reflective shadow maps that virtual point lights are sampled from, attenuated by media."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...lighting.kit import Kit
from ...maths.transforms import F64
from ...media.attenuated_maps import AttenuatedMaps
from ...media.gpu_media import GpuMedia
from ...scene.scene import Scene
from ...surface.light_maps import LightMaps
from ..settings import PopSettings
from .reflected import ReflectedLights


class ReflectedMaps:
    """Maps of the scene's lights, attenuated by media, and of the sky; `reflected` is all of it."""

    def __init__(self, kit: Kit, media: GpuMedia, settings: PopSettings) -> None:
        """`settings` say how many virtual point lights there are, and how large the maps."""
        self._kit, self._media = kit, media
        lights = kit.context.scene.lights
        self._maps = LightMaps(kit.gpu, lights, settings.virtual_resolution)
        self._attenuated = [
            AttenuatedMaps(kit.gpu, maps, media, owners)
            for maps, owners in zip(self._maps.groups, self._maps.owners, strict=True)
        ]
        self._media_version = -1
        all_maps = (*self._attenuated, kit.sky.maps)
        self.reflected = ReflectedLights(
            all_maps, kit.blockers, kit.placement, settings.virtual_lights
        )

    def encode(self, commands: Commands, scene: Scene, low: F64, high: F64) -> None:
        """Redraw and attenuate what changed; media are up to date. low..high: the scene, m."""
        is_drawn = self._maps.encode(commands, self._kit.meshes, scene.lights, low, high)
        if is_drawn or self._media.version != self._media_version:
            self._media_version = self._media.version
            self.reflected.version += 1
            for maps in self._attenuated:
                maps.attenuate(commands, self._kit.lights.table)


def reflected_maps(kit: Kit, media: GpuMedia, settings: PopSettings) -> ReflectedMaps | None:
    """The maps of a technique's virtual point lights, where there are to be any."""
    has_any = bool(kit.context.scene.meshes and settings.virtual_lights)
    return ReflectedMaps(kit, media, settings) if has_any else None
