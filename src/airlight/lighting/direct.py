"""The technique `direct`, and what every technique lights surfaces with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer, Texture, linear_sampler, nearest_sampler
from ..lattice.blockers import Blockers
from ..lattice.lookup import LatticeTextures
from ..lattice.placement import LatticeParams, Placement, fitted
from ..lattice.table import LatticeTable
from ..scene.scene import Scene
from ..scene.settings import setting
from ..surface.geometry import GpuScene
from .glossy import is_any_glossy
from .glossy_pixels import GlossyPixels, can_list
from .lattice_box import lattice_box
from .lighting import LightAir, Lighting, LightingParams, Part
from .lights import Lights
from .occlusion import Occlusion
from .places import Places, can_keep
from .sky import Sky
from .view import View


@dataclass(frozen=True)
class SurfaceSettings:
    """What lighting surfaces needs in every technique."""

    resolution: int = setting(32, "cells along the lattice's longest side", low=4, high=256)
    bounds: tuple[float, ...] = setting(
        (), "box of the lattice, x0,y0,z0,x1,y1,z1; else the scene and the medium in it", unit="m"
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
    glossy_rays: bool = setting(
        True, "whether smooth surfaces mirror the lattice along rays, not just their own cell"
    )
    ambient_occlusion: bool = setting(
        True, "whether what is smaller than cells shades sky and bounced light"
    )
    occlusion_radius: float = setting(
        2.0, "how far that is looked for", unit="cells", low=0.01, high=8.0
    )


class Direct:
    """The technique `direct`: lights with shadows, emission, sky; no bounced light."""

    Settings: ClassVar[type[SurfaceSettings]] = SurfaceSettings
    is_in_air: ClassVar[bool] = False  # whether its lattices hold the light in the medium

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: SurfaceSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        self.gpu, self.meshes, self.settings = gpu, meshes, settings
        self.placement = self.outermost(scene)
        self.lights = Lights(
            gpu,
            scene.lights,
            scene.environment,
            settings.shadow_resolution,
            settings.lamp_resolution,
        )
        cells = self.texture_size
        self.sky = Sky(
            gpu, scene.environment, self.placement, settings.sky_lights, settings.sky_resolution,
            cells,
        )  # fmt: skip
        self.blockers = Blockers(gpu, scene, meshes, self.placement, settings.surfels, size=cells)
        self.textures = LatticeTextures(gpu, self.placement, cells)
        self.table = LatticeTable(gpu, self.lattice_count)
        self.black = Buffer(gpu, "no light", 3 * int(np.prod(cells)) * 16)
        self._passes: dict[Part, Lighting] = {}  # made at the first draw: subclasses bring air
        self.glossy: GlossyPixels | None = None
        self._places: Places | None = None
        self._occlusion: Occlusion | None = None
        self._is_glossy = settings.glossy_rays and is_any_glossy(m.material for m in scene.meshes)
        self.linear, self.nearest = linear_sampler(gpu), nearest_sampler(gpu)
        self.power_scale = 1.0
        self.is_paper = False
        self.damping = 0.0
        # Whether there is bounced light, and whether it bounces again.
        self.is_bounced, self.is_bouncing = False, True
        self.air: LightAir | None = None

    def outermost(self, scene: Scene) -> Placement:
        """The largest lattice, or the only one."""
        return fitted(*self.box(scene), self.settings.resolution)

    def box(self, scene: Scene) -> tuple[Any, Any]:
        """What its lattices cover, metres."""
        return lattice_box(scene, self.settings.bounds, in_air=self.is_in_air)

    @property
    def texture_size(self) -> tuple[int, int, int]:
        """Cells of the textures that the lattices share."""
        return self.placement.count

    @property
    def lattice_count(self) -> int:
        """How many lattices surfaces read."""
        return 1

    @property
    def placements(self) -> tuple[Placement, ...]:
        """Where they are, the finest first."""
        return (self.placement,)

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Everything that does not depend on the camera."""
        low, high = self._bounds(scene)
        with commands.stage("shadow maps"):
            self.lights.encode(commands, self.meshes, scene.lights, scene.environment, low, high)
        with commands.stage("blockers"):
            self.blockers.encode(commands)
        with commands.stage("sky"):
            self.sky.encode(commands, self.meshes, scene.environment, self.blockers.bound)

    def draw(self, commands: Commands, view: View) -> None:
        """The picture: G-buffer and lighting."""
        with commands.stage("g-buffer"):
            view.gbuffer.encode(commands, self.meshes, view.clip_from_world)
        is_occluded = self.settings.ambient_occlusion and bool(self.meshes.draws)
        has_near_light = is_occluded and self._has_near_light
        if has_near_light:
            with commands.stage("lighting"):
                self._light(commands, view, "lights")
        if is_occluded:
            with commands.stage("ambient occlusion"):
                self._occlude(commands, view)
        with commands.stage("lighting"):
            self._light(commands, view, "lattices" if has_near_light else "whole")

    @property
    def _has_near_light(self) -> bool:
        """Whether near surfaces light each other: where there is bounced light at all."""
        has_lights = self.lights.parallel.layers + self.lights.local.layers > 0
        return self.is_bounced and (has_lights or self.blockers.is_emissive)

    def _occlude(self, commands: Commands, view: View) -> None:
        g = view.gbuffer
        wanted, finest, coarsest = self.settings.occlusion_radius, *self._end_cells
        has_light = self._has_near_light
        if self._occlusion is None:
            self._occlusion = Occlusion(self.gpu, has_light=has_light)
        self._occlusion.encode(
            commands, g.depth, g.normal, view.occlusion, view.world_from_clip,
            wanted * finest.cell, growth=wanted * 2.0 / max(finest.count),
            largest=wanted * coarsest.cell, lit=view.layers.lit if has_light else None,
        )  # fmt: skip

    @property
    def _end_cells(self) -> tuple[Placement, Placement]:
        """The finest and the coarsest lattice: what is smaller than their cells occludes."""
        return self.placements[0], self.placements[-1]

    def _light(self, commands: Commands, view: View, part: Part) -> None:
        g, layers = view.gbuffer, view.layers
        params = LightingParams(
            world_from_clip=view.world_from_clip, eye=view.eye, light_count=self.lights.count,
            size=view.size, environment_rotation=self.lights.background.rotation, has_lattice=1,
        )  # fmt: skip
        self._make_beside(view.size)
        values: dict[str, Any] = {
            "params": params, **self.lattice_bound, **self.lights.bound,
            **(self.air.bound if self.air else {}), "depth": g.depth, "albedo": g.albedo,
            "normal": g.normal, "emission": g.emission, "near_texels": view.occlusion.near,
            "lit": layers.lit if part == "lattices" else g.albedo, "picture_sampler": self.nearest,
            "sky_cube": self.sky_cube, **self.blockers.bound, "linear_clamp": self.linear,
        }  # fmt: skip
        if self._places and part == "lattices":
            key = (g, g.version, view.eye, self.placements, self.sky_version, self.blockers.version)
            placed = self._places.encode(commands, view.size, key, values)
            part, values = ("placed", values | placed) if placed else (part, values)
        lighting = self._lighting_of(part)
        if self.glossy is None or part == "lights":
            targets = (layers.lit,) if part == "lights" else layers.targets
            lighting.draw(commands, targets, **values)
            return
        listed = self.glossy.empty(commands, view.size)
        lighting.draw(commands, view.layers.targets, **values, **listed)
        self.glossy.encode(commands, view.layers.targets, values)

    @property
    def _known(self) -> dict[str, bool]:
        """What all passes for surfaces must know."""
        return {"is_occluded": self.settings.ambient_occlusion, "has_sky": self._has_sky,
                "is_one_lattice": self.table.count == 1}  # fmt: skip

    def _make_beside(self, size: tuple[int, int]) -> None:
        """What software drivers draw apart for pictures of `size`, pixels: gloss, and places."""
        is_listed = self._is_glossy and self.gpu.takes_cpu_paths and can_list(self.gpu, size)
        if self._passes and is_listed == (self.glossy is not None):
            return
        for made in (self.glossy, self._places):
            if made:
                made.release()
        self._passes.clear()
        self.glossy = GlossyPixels(self.gpu, **self._known) if is_listed else None
        has_places = self._has_places(is_listed)
        self._places = Places(self.gpu, **self._known, is_listed=is_listed) if has_places else None

    def _lighting_of(self, part: Part) -> Lighting:
        if part not in self._passes:
            self._passes[part] = Lighting(
                self.gpu, self.air, is_glossy=self._is_glossy, damping=self.damping,
                has_surfaces=bool(self.meshes.draws), has_suns=self.lights.parallel.layers > 0,
                has_lamps=self.lights.local.layers > 0, **self._known,
                is_one_sun=self.lights.count == self.lights.parallel.layers == 1,
                is_listed=self.glossy is not None and part != "lights",
                part=part, is_bouncing=self.is_bouncing,
            )  # fmt: skip
        return self._passes[part]

    def _has_places(self, is_listed: bool) -> bool:
        """Whether places are kept: of one lattice."""
        return can_keep(self.gpu) and self.table.count == 1 and is_listed == self._is_glossy

    @property
    def _has_sky(self) -> bool:
        """Whether `sky_cube` may ever hold light: without maps the own one stays black."""
        return self.sky.maps.layers > 0 or self.sky_cube is not self.sky.skylight.cube

    @property
    def sky_cube(self) -> Texture:
        """The environment's direct light on surfaces; through the air where that is seen."""
        return self.sky.skylight.cube

    @property
    def sky_version(self) -> int:
        """Of what `sky_cube` holds."""
        return self.sky.skylight.version

    @property
    def lattice_bound(self) -> dict[str, Any]:
        """The solved lattices that surfaces take light from, by slot name; black here."""
        return {"lattices": self.table.filled(self.lattice_params), **self.textures.bound}

    @property
    def lattice_params(self) -> list[LatticeParams]:
        """Those lattices, the finest first."""
        return [p.params(self.power_scale, is_paper=self.is_paper) for p in self.placements]

    def _bounds(self, scene: Scene) -> tuple[Any, Any]:
        """What lights must see, metres; from the instances, since a scene's own take a loop."""
        return self.meshes.bounds if self.meshes.draws and not scene.volumes else scene.bounds

    def pictures(self, view: View) -> dict[str, Texture]:
        """The radiance layers that `draw` writes, by name; they add up to the picture."""
        return {"direct": view.layers.direct, "indirect": view.layers.indirect}

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels; what depends on it here is the view's."""

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return {"lattice": list(self.placement.count), "iterations": 0}

    def release(self) -> None:
        """Give the memory back."""
        parts = (self.lights, self.sky, self.blockers, self.textures, self.table, self.black)
        for part in parts:
            part.release()
        for made in (self.glossy, self._places):
            if made:
                made.release()
