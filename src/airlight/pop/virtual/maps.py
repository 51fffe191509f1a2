"""The reflective shadow maps that virtual point lights are sampled from, attenuated by media."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...gpu.commands import Commands
from ...lighting.kit import Kit
from ...maths.delta_beam import beam_loss
from ...maths.transforms import F64
from ...media.attenuated_maps import AttenuatedMaps, AttenuatedSkyMaps
from ...media.density_grids import ColumnPlan
from ...media.gpu_media import GpuMedia
from ...media.reduced import AnyMedium, ChangedMedia
from ...scene.medium import medium_box
from ...scene.scene import Scene
from ...surface.light_maps import LightMaps
from ..settings import PopSettings
from .reflected import ReflectedLights


class ReflectedMaps:
    """Maps of the scene's lights and of the sky, attenuated by media; `reflected` is all of it.

    Light that media scattered forwards alone arrives, too; the paper's scheme has none of it.
    """

    def __init__(self, kit: Kit, settings: PopSettings) -> None:
        """`settings` say how many virtual point lights there are, and how large the maps."""
        # Virtual point lights are sampled from flux that media on the path from the light have
        # attenuated.
        self._kit = kit
        self._forward = None if settings.scheme == "paper" else ChangedMedia(forward_scaled)
        scene = kit.context.scene
        self._media = GpuMedia(
            kit.gpu,
            self._attenuating(scene),
            light_count=kit.lights.count,
            columns=ColumnPlan(shared=kit.shared),
        )
        # Maps of the lights have a resolution of their own; the sky's are those of the kit.
        self._maps = LightMaps(kit.gpu, scene.lights, settings.virtual_resolution)
        self._attenuated = [
            AttenuatedMaps(kit.gpu, maps, self._media, owners)
            for maps, owners in zip(self._maps.groups, self._maps.owners, strict=True)
        ]
        self._sky = AttenuatedSkyMaps(kit.gpu, kit.sky.maps, self._media)
        self._seen = (-1, -1)
        self.reflected = ReflectedLights(
            (*self._attenuated, self._sky), kit.blockers, kit.placement, settings.virtual_lights
        )

    def encode(self, commands: Commands, scene: Scene, low: F64, high: F64) -> None:
        """Redraw and attenuate what changed; the sky is up to date. low..high: the scene, m."""
        # Media first, which attenuate; then the maps of lights that moved.
        self._media.update(commands, self._attenuating(scene), low, high)
        is_drawn = self._maps.encode(commands, self._kit.meshes, scene.lights, low, high)
        media, sky = self._media.version, self._kit.sky.version
        if not is_drawn and (media, sky) == self._seen:
            return
        # Virtual point lights are sampled again where this version is another one.
        self.reflected.version += 1
        for maps in self._attenuated:
            maps.attenuate(commands, self._kit.lights.table)
        # A sky's maps do not move with the lights.
        if (media, sky) != self._seen:
            self._sky.attenuate(commands, _reach(scene, low, high))
        self._seen = (media, sky)

    def _attenuating(self, scene: Scene) -> Scene:
        return self._forward.of(scene) if self._forward else scene


def _reach(scene: Scene, low: F64, high: F64) -> float:
    """How far apart surfaces and media may lie, m: the sky's maps hold surfaces alone."""
    # The medium may reach beyond the surfaces.
    if scene.medium is not None:
        box = medium_box(scene.medium, low, high, scene.camera.position)
        low, high = np.minimum(low, box[0]), np.maximum(high, box[1])
    return float(np.linalg.norm(high - low))


def reflected_maps(kit: Kit, settings: PopSettings) -> ReflectedMaps | None:
    """The maps of a technique's virtual point lights, where there are to be any."""
    has_any = bool(kit.context.scene.meshes and settings.virtual_lights)
    return ReflectedMaps(kit, settings) if has_any else None


def forward_scaled(medium: AnyMedium) -> AnyMedium:
    """The medium as light meets it on its way to surfaces that reflect it into media again.

    Of what a medium scatters, the share g^(3/2) stays in its beam (`maths.delta_beam`), and reaches
    the surfaces behind: in the shadow of smoke of g .7 that is most of the light there is to
    reflect. What it scatters is as it was.
    """
    # Light is lost to the beam where it is absorbed or scattered otherwise than forwards.
    lost = np.asarray(medium.sigma_t) * beam_loss(medium.g, medium.albedo)
    r, g, b = (float(x) for x in lost)
    return replace(medium, sigma_t=(r, g, b))
