"""The scene's reduced media on the device, which all lattices of a scene share.

scene's media -> reduced media (similarity theory) -> on the device, for its lights and the sky's
"""

from __future__ import annotations

import dataclasses

from ..fields import Frame
from ..gpu.commands import Commands
from ..lighting.kit import Kit
from ..media.density_grids import ColumnPlan, sky_columns
from ..media.gpu_media import GpuMedia
from ..media.reduced import is_forward, reduced_scene
from ..scene.checks import Rgb
from ..scene.scene import Scene
from .settings import densest_medium
from .surface_light import NO_MEDIUM

SLANT_MEDIA = 16  # beyond so many, light comes slantwise from those alone that are on its path
_TAPS = 4


class ReducedMedia:
    """Media under the scene's `lights` and under those that stand for the `sky`."""

    def __init__(self, kit: Kit, scene: Scene) -> None:
        self._kit = kit
        # Light is attenuated towards the scene's lights and towards those that stand for the sky.
        reduced = reduced_scene(scene)
        self.lights = GpuMedia(
            kit.gpu,
            reduced,
            light_count=kit.lights.count,
            columns=ColumnPlan(shared=kit.shared),
        )
        self.sky = GpuMedia(
            kit.gpu,
            self._under_sky(reduced),
            light_count=sky_capacity(kit),
            columns=sky_columns(kit.lattices.placements[0].cell, kit.shared),
        )
        self.has_forward = self.is_reduced = False
        # Beside each part of a cell; the borders of volumes show where there are few.
        self.taps = _TAPS if 0 < len(scene.volumes) <= SLANT_MEDIA else 1
        self.sigma_s: Rgb = NO_MEDIUM.sigma_s
        self.sigma_t: Rgb = NO_MEDIUM.sigma_t

    def update(self, commands: Commands, frame: Frame) -> None:
        """Bring the media up to date; `sigma_s`, `sigma_t`, m^-1, are the densest one's."""
        # Lattices solve reduced media; forward light is beside them where any medium has some.
        reduced = reduced_scene(frame.scene)
        self.has_forward = is_forward(frame.scene)
        self.is_reduced = is_forward(frame.scene, least=0.0)
        self.lights.update(commands, reduced, *frame.bounds)
        self.sky.update(commands, self._under_sky(reduced), *frame.bounds)
        self.sigma_s, self.sigma_t = densest_medium(reduced)

    @property
    def version(self) -> int:
        """Raised whenever the media changed."""
        return self.lights.version

    def _under_sky(self, reduced: Scene) -> Scene:
        """The reduced media under the lights that stand for the sky."""
        return dataclasses.replace(reduced, lights=tuple(self._kit.sky.lights))


def sky_capacity(kit: Kit) -> int:
    """The most lights that will ever stand for the sky: a turning sky may bring more."""
    return max(len(kit.sky.lights), kit.sky.maps.layers)
