"""The technique `lpv`: direct light, and light that bounced, on one lattice (Kaplanyan2010)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, cast

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.emission import InjectEmission, emitted_flux
from ..lattice.inject import Inject, Resolve, fixed_point_scale, flux_bound, new_sums
from ..lattice.lookup import texture_scale
from ..lighting.direct import Direct, SurfaceSettings
from ..maths.lattice6 import Scheme
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from ..scene.settings import setting
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views, view_count
from ..surface.reflective import ReflectiveShadowMaps
from .propagate import Propagate


@dataclass(frozen=True)
class LpvSettings(SurfaceSettings):
    """What light propagation volumes can be told."""

    scheme: str = setting("centroid", "how a hop keeps direction", choices=("centroid", "paper"))
    iterations: int = setting(64, "propagation steps", low=0, high=1024)
    map_resolution: int = setting(
        256, "side of reflective shadow maps", unit="px", low=8, high=4096
    )
    occlusion: bool = setting(True, "whether surfaces stop propagating light")
    bounces: bool = setting(True, "whether stopped light bounces on, beyond the first bounce")
    damping: float = setting(
        0.0, "how strongly light that falls off away from a surface is taken for a leak", low=0,
        high=10,
    )  # fmt: skip


class Lpv(Direct):
    """Reflective shadow maps -> virtual point lights -> cells -> propagation -> surfaces."""

    Settings: ClassVar[type[SurfaceSettings]] = LpvSettings

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: LpvSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        super().__init__(gpu, scene, meshes, settings, size)
        self.lpv = settings
        self.is_paper = settings.scheme == "paper"
        self.damping = settings.damping
        # The paper ignores blockers in the first step, so its lobes stay cosine lobes.
        self._is_shaped = settings.occlusion and not self.is_paper
        suns, lamps = _by_kind(scene.lights)
        lamp_side = max(8, settings.map_resolution // 2)
        self.sun_maps = ReflectiveShadowMaps(gpu, "suns", settings.map_resolution, len(suns))
        self.lamp_maps = ReflectiveShadowMaps(
            gpu, "lamps", lamp_side, sum(view_count(lamp) for lamp in lamps)
        )
        self.inject, self.emission, self.resolve = Inject(gpu), InjectEmission(gpu), Resolve(gpu)
        self._steady_scale, self._emitted = 0.0, emitted_flux(scene.meshes)
        self.sums = new_sums(gpu, self.placement)
        nbytes = 3 * self.placement.cells * 16
        self.steady = Buffer(gpu, "steady light", nbytes)
        self.injected = Buffer(gpu, "injected", nbytes)
        self.propagate = Propagate(
            gpu,
            self.placement,
            cast(Scheme, settings.scheme),
            is_blocked=settings.occlusion,
            is_reflecting=settings.bounces,
        )

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Shadow maps -> inject -> propagate -> textures."""
        low, high = self._bounds(scene)
        flux = flux_bound([*scene.lights, *self.sky.lights], low, high) + self._emitted
        scale, self.power_scale = fixed_point_scale(flux), texture_scale(flux)
        with commands.stage("shadow maps"):
            self.lights.encode(commands, self.meshes, scene.lights, scene.environment, low, high)
        with commands.stage("blockers"):
            moved = self.blockers.encode(commands)
        with commands.stage("sky"):
            sky_changed = self.sky.encode(
                commands, self.meshes, scene.environment, self.blockers.walls
            )
        with commands.stage("reflective shadow maps"):
            self._draw_maps(commands, scene.lights, low, high)
        with commands.stage("inject"):
            if sky_changed or moved or scale != self._steady_scale:
                self._inject_steady(commands, scale)
            for maps in (self.sun_maps, self.lamp_maps):
                if maps.layers:
                    self._inject(commands, maps, scale)
            self.resolve.encode(
                commands, self.placement, self.sums, self.steady, self.injected, scale
            )
        with commands.stage("propagate"):
            total = self.propagate.encode(
                commands, self.injected, self.blockers.faces, self.lpv.iterations
            )
        with commands.stage("pack"):
            self.textures.encode(
                commands, self.injected, total, self.power_scale, is_shaped=self._is_shaped
            )

    def _draw_maps(
        self, commands: Commands, lights: tuple[Light, ...], low: Any, high: Any
    ) -> None:
        for group, maps in zip(_by_kind(lights), (self.sun_maps, self.lamp_maps), strict=True):
            if group:
                views = light_views(group, np.asarray(low), np.asarray(high), maps.resolution)
                maps.encode(commands, self.meshes, group, views)

    def _inject(self, commands: Commands, maps: ReflectiveShadowMaps, scale: float) -> None:
        self.inject.encode(
            commands, maps, self.placement, self.blockers.walls, self.sums, scale,
            is_shaped=self._is_shaped,
        )  # fmt: skip

    def _inject_steady(self, commands: Commands, scale: float) -> None:
        """What changes only with the environment or the geometry: the sky's bounce, emission."""
        self._steady_scale = scale
        if self.sky.maps.layers:
            self._inject(commands, self.sky.maps, scale)
        if self.blockers.is_emissive:
            self.emission.encode(
                commands, self.blockers, self.sums, scale, is_shaped=self._is_shaped
            )
        self.resolve.encode(commands, self.placement, self.sums, self.black, self.steady, scale)

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return {"lattice": list(self.placement.count), "iterations": self.lpv.iterations}

    def release(self) -> None:
        """Give the memory back."""
        super().release()
        for part in (
            self.sun_maps,
            self.lamp_maps,
            self.sums,
            self.steady,
            self.injected,
            self.propagate,
        ):
            part.release()


def _by_kind(lights: tuple[Light, ...]) -> tuple[list[Light], list[Light]]:
    suns: list[Light] = [x for x in lights if isinstance(x, DirectionalLight)]
    return suns, [x for x in lights if not isinstance(x, DirectionalLight)]
