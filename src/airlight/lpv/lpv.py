"""The technique `lpv`: direct light, and light that bounced, on one lattice (Kaplanyan2010)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import SettingsError
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer, linear_sampler
from ..lattice.blockers import Blockers
from ..lattice.emission import InjectEmission, emitted_flux
from ..lattice.inject import Inject, Resolve, fixed_point_scale, flux_bound, new_sums
from ..lattice.lookup import LatticeTextures, texture_scale
from ..lattice.placement import Placement, fitted
from ..lighting.lighting import Lighting, LightingParams
from ..lighting.lights import Lights
from ..lighting.sky import Sky
from ..lighting.view import View
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from ..scene.settings import setting
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views, view_count
from ..surface.reflective import ReflectiveShadowMaps
from .propagate import Propagate


@dataclass(frozen=True)
class SurfaceSettings:
    """What lighting surfaces needs in every technique."""

    resolution: int = setting(32, "cells along the lattice's longest side", low=4, high=256)
    bounds: tuple[float, ...] = setting(
        (), "box of the lattice, x0,y0,z0,x1,y1,z1; else the scene", unit="m"
    )
    shadow_resolution: int = setting(
        2048, "side of a sun's shadow map", unit="px", low=16, high=8192
    )
    lamp_resolution: int = setting(
        512, "side of a lamp's shadow maps", unit="px", low=16, high=4096
    )
    sky_lights: int = setting(
        128, "directional lights that stand for the environment", low=0, high=512
    )
    sky_resolution: int = setting(96, "side of their maps", unit="px", low=8, high=1024)
    surfels: int = setting(
        200_000, "samples of all surfaces, for occlusion", low=1, high=10_000_000
    )


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


class Direct:
    """The technique `direct`: lights with shadows, emission, sky; no bounced light."""

    Settings = SurfaceSettings

    def __init__(self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: SurfaceSettings) -> None:
        self.gpu, self.meshes, self.settings = gpu, meshes, settings
        self.placement = scene_placement(scene, settings)
        self.lights = Lights(
            gpu,
            scene.lights,
            scene.environment,
            settings.shadow_resolution,
            settings.lamp_resolution,
        )
        self.sky = Sky(
            gpu, scene.environment, self.placement, settings.sky_lights, settings.sky_resolution
        )
        self.blockers = Blockers(gpu, scene, meshes, self.placement, settings.surfels)
        self.textures = LatticeTextures(gpu, self.placement)
        self.black = Buffer(gpu, "no light", 3 * self.placement.cells * 16)
        self.lighting = Lighting(gpu)
        self.linear = linear_sampler(gpu)
        self.power_scale = 1.0
        self.is_paper = False

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Everything that does not depend on the camera."""
        low, high = self._bounds(scene)
        with commands.stage("shadow maps"):
            self.lights.encode(commands, self.meshes, scene.lights, scene.environment, low, high)
        with commands.stage("blockers"):
            self.blockers.encode(commands)
        with commands.stage("sky"):
            self.sky.encode(commands, self.meshes, scene.environment, self.blockers.walls)

    def draw(self, commands: Commands, view: View) -> None:
        """The picture: G-buffer and lighting."""
        with commands.stage("g-buffer"):
            view.gbuffer.encode(commands, self.meshes, view.clip_from_world)
        with commands.stage("lighting"):
            self._light(commands, view)

    def _light(self, commands: Commands, view: View) -> None:
        g = view.gbuffer
        params = LightingParams(
            world_from_clip=view.world_from_clip, eye=view.eye, light_count=self.lights.count,
            size=view.size, environment_rotation=self.lights.background.rotation, has_lattice=1,
        )  # fmt: skip
        self.lighting.draw(
            commands, view.layers.targets, params=params,
            lattice=self.placement.params(self.power_scale, is_paper=self.is_paper),
            **self.lights.bound,
            depth=g.depth, albedo=g.albedo, normal=g.normal, emission=g.emission,
            sky_cube=self.sky.skylight.cube, **self.textures.bound,
            **self.blockers.bound, linear_clamp=self.linear,
        )  # fmt: skip

    def _bounds(self, scene: Scene) -> tuple[Any, Any]:
        """What lights must see, metres; from the instances, since a scene's own take a loop."""
        return self.meshes.bounds if self.meshes.draws and not scene.volumes else scene.bounds

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return {"lattice": list(self.placement.count), "iterations": 0}

    def release(self) -> None:
        """Give the memory back."""
        for part in (self.lights, self.sky, self.blockers, self.textures, self.black):
            part.release()


class Lpv(Direct):
    """Reflective shadow maps -> virtual point lights -> cells -> propagation -> surfaces."""

    Settings = LpvSettings

    def __init__(self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: LpvSettings) -> None:
        super().__init__(gpu, scene, meshes, settings)
        self.lpv = settings
        self.is_paper = settings.scheme == "paper"
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
            settings.scheme,
            is_blocked=settings.occlusion,  # type: ignore[arg-type]
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


def scene_placement(scene: Scene, settings: SurfaceSettings) -> Placement:
    """The lattice over the scene, or over the box that the settings give."""
    if not settings.bounds:
        return fitted(*scene.bounds, settings.resolution)
    if len(settings.bounds) != 6:
        raise SettingsError(
            f"setting bounds has {len(settings.bounds)} numbers", remedy="Give x0,y0,z0,x1,y1,z1"
        )
    low, high = settings.bounds[:3], settings.bounds[3:]
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise SettingsError(f"setting bounds is empty: {list(low)} to {list(high)}")
    return fitted(low, high, settings.resolution)


def _by_kind(lights: tuple[Light, ...]) -> tuple[list[Light], list[Light]]:
    suns: list[Light] = [x for x in lights if isinstance(x, DirectionalLight)]
    return suns, [x for x in lights if not isinstance(x, DirectionalLight)]
