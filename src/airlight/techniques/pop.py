"""The technique `pop`: every medium by principal ordinates (Elek2014), surfaces lit directly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.direct import Direct, SurfaceSettings
from ..lighting.view import View
from ..march.air import Air
from ..march.compose import Compose
from ..pop.media import PopMedia, PopMediaSettings
from ..pop.reflected_maps import reflected_maps
from ..pop.visibility import Surfaces
from ..scene.scene import Scene
from ..scene.settings import setting
from ..surface.geometry import GpuScene


@dataclass(frozen=True)
class PopTechniqueSettings(SurfaceSettings, PopMediaSettings):
    """Surfaces, and principal ordinates."""

    virtual_lights: int = setting(
        64, "points of lit surfaces whose reflected light media see, once; 0: none",
        low=0, high=512,
    )  # fmt: skip


class Pop(Direct):
    """Media solved each on a grid of its own; surfaces in their shadow."""

    Settings = PopTechniqueSettings

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: PopTechniqueSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        super().__init__(gpu, scene, meshes, settings, size)
        self.shadow = Air(gpu, scene, light_count=self.lights.count)
        self.air = self.shadow
        self.reflected = reflected_maps(scene, settings, self, self.shadow)
        virtual = self.reflected.reflected if self.reflected else None
        surfaces = Surfaces(meshes, self.lights, self.sky, virtual, self.blockers)
        self.media = PopMedia(gpu, scene, settings, surfaces if scene.meshes else None)
        self.composed = Compose(gpu, size)

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels."""
        self.composed.resize(size)

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Surfaces, then media."""
        if self.meshes.draws:
            super().solve(commands, scene)
        else:  # a sky that lights no surface is not worth its lattice
            with commands.stage("shadow maps"):
                self.lights.encode(commands, self.meshes, scene.lights, scene.environment,
                                   *self._bounds(scene))  # fmt: skip
        self.shadow.update(commands, scene, *self._bounds(scene))
        if self.reflected:
            with commands.stage("reflective shadow maps"):
                self.reflected.encode(commands, self.meshes, scene.lights, *self._bounds(scene))
        self.media.solve(commands, scene)

    def draw(self, commands: Commands, view: View) -> None:
        """Surfaces, media before them, and both together."""
        super().draw(commands, view)
        self.media.draw(commands, view)
        with commands.stage("compose"):
            self.composed.encode(
                commands, direct=view.layers.direct, indirect=view.layers.indirect,
                transmittance=self.media.transmittance,
            )  # fmt: skip

    def pictures(self, view: View) -> dict[str, Texture]:
        """Surfaces through the media, all light they scatter, and what they let through."""
        return {
            "direct": self.composed.direct,
            "indirect": self.composed.indirect,
            "scattered": self.media.scattered,
            "transmittance": self.media.transmittance,
        }

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return {**super().stats, **self.media.stats}

    def release(self) -> None:
        """Give the memory back."""
        super().release()
        for part in (self.media, self.reflected, self.shadow, self.composed):
            if part is not None:
                part.release()
