"""What the solvers of one scene share: lights with shadow maps, the sky, the lattices.

context   device, scene, meshes, size of the image
kit       rays; shadow maps -> blockers -> the sky's maps -> the sky's light in all cells
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..area.emitters import Emitters
from ..area.lighting import AreaShadows
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.lanes import has_row_lanes
from ..gpu.shared import Shared
from ..lattice.blockers import Blockers
from ..lattice.irradiance import Irradiance, SkyIrradiance
from ..lattice.lattices import Lattices, MakeBlockers
from ..lattice.lookup import LatticeTextures
from ..lattice.nested import Nest, nested
from ..lattice.placement import STRAIGHT, Hull, Placement, fitted
from ..maths.transforms import F64, triple
from ..scene.scene import Scene
from ..scene.settings import setting
from ..surface.geometry import GpuScene
from .hidden import Hidden
from .lattice_box import lattice_axes, lattice_extent, with_medium_around
from .lights import Lights
from .shadow_rays import SceneRays, ShadowRays
from .sky import Sky


@dataclass(frozen=True)
class SurfaceSettings:
    """The settings that lighting surfaces has in every technique."""

    resolution: int = setting(32, "cells along the lattice's longest side", low=4, high=256)
    bounds: tuple[float, ...] = setting(
        (), "box of the lattice, x0,y0,z0,x1,y1,z1; else the scene and the medium in it", unit="m"
    )
    follow_walls: bool = setting(
        True,
        "whether the lattice turns to the walls and cells end at them; else it follows the world",
    )
    shadow_resolution: int = setting(
        2048,
        "side of a directional light's shadow map, less where there are many",
        unit="px",
        low=16,
        high=8192,
    )
    lamp_resolution: int = setting(
        512,
        "side of a local light's shadow maps, less where there are many",
        unit="px",
        low=16,
        high=4096,
    )
    shadow_rays: bool = setting(
        True, "whether rays decide in stills where shadow maps of lights without extent are unsure"
    )
    area_samples: int = setting(
        16,
        "points of a light with extent that surfaces look for; all have 2.5 times as many",
        low=1,
        high=64,
    )
    area_lights: int = setting(
        20, "lights with extent, beyond which those close together count as one", low=1, high=64
    )
    sky_lights: int = setting(
        128, "directional lights that stand for the environment", low=0, high=512
    )
    sky_resolution: int = setting(96, "side of their maps", unit="px", low=8, high=1024)
    surfels: int = setting(
        200_000, "samples of all surfaces, for occlusion", low=1, high=10_000_000
    )
    translucent_layers: int = setting(
        4, "translucent surfaces one behind the other that a pixel shows", low=0, high=16
    )
    glossy_rays: bool = setting(
        True,
        "whether smooth surfaces mirror along rays, what triangles are where a frame gathers and "
        "the lattice's light else, not just their own cell",
    )
    hidden_lights: bool = setting(
        False,
        "whether light that closed opaque walls part from the eye is computed, too, as in exports",
    )
    ambient_occlusion: bool = setting(
        True, "whether what is smaller than cells shades sky and indirect light"
    )
    occlusion_radius: float = setting(
        2.0, "how far that is looked for", unit="cells", low=0.01, high=8.0
    )


@dataclass(frozen=True, eq=False)
class Context:
    """What a technique is made for. `size`: of the image, pixels.

    `commands`, where a frame of the scene as it is follows at once: what needs neither lattices nor
    solvers is submitted before they are made, and the device draws while the host makes them.
    """

    gpu: Gpu
    scene: Scene
    meshes: GpuScene
    size: tuple[int, int]
    commands: Commands | None = None


class Kit:
    """Lights, sky and lattices of one scene, updated once a frame for all solvers."""

    _is_first = True  # until a frame is encoded

    def __init__(
        self,
        context: Context,
        settings: SurfaceSettings,
        nest: Nest | None = None,
        *,
        make_blockers: MakeBlockers = Blockers,
    ) -> None:
        """`nest`: where lattices are, if not one over the scene. Raises SettingsError.

        `gpu` owns all that a technique makes on the device, solvers and surfaces included.
        """
        self.gpu = gpu = context.gpu.scope()
        nest = nest or scene_nest(context.scene, settings)
        self.emitters = Emitters(
            context.scene,
            samples=settings.area_samples,
            most=settings.area_lights,
            cell=nest.levels[0].cell,
        )
        scene = self.emitters.of(context.scene)
        self.context, self.settings = replace(context, gpu=gpu, scene=scene), settings
        self.meshes, self.shared = context.meshes, Shared()
        self.box: tuple[F64, F64] = (np.zeros(3), np.ones(3))
        """What lights saw last, metres."""
        # Samples of lights with extent cast shadows into media alone.
        has_media = scene.medium is not None or bool(scene.volumes)
        self.lights = Lights(
            gpu,
            scene.lights,
            scene.environment,
            (settings.shadow_resolution, settings.lamp_resolution),
            mapped=len(scene.lights) if has_media else self.emitters.plain,
            has_panes=self.meshes.has_translucent,
            has_media=has_media,
        )
        # The device draws the sky's maps while the host samples surfels and makes solvers.
        self.sky = Sky(gpu, scene.environment, settings.sky_lights, settings.sky_resolution)
        if context.commands:
            self._begin(context.commands, scene, nest.over_inner)
        self.lattices = Lattices(
            gpu,
            scene,
            self.meshes,
            nest,
            surfels=settings.surfels,
            sky_lights=settings.sky_lights,
            make_blockers=make_blockers,
        )
        self.rays = SceneRays(gpu, self.meshes)
        self.area_shadows: AreaShadows | None = None
        """Of lights with extent, where there are any and surfaces that they could light."""
        if self.emitters.count and self.meshes.draws:
            self.area_shadows = AreaShadows(gpu, self.emitters, settings.lamp_resolution)

    def _begin(self, commands: Commands, scene: Scene, placement: Placement) -> None:
        """Submit the sky's maps, most of a first frame's work on a CPU adapter, for a lattice."""
        # An answer of the device would wait for them, so it is asked before.
        has_row_lanes(self.gpu)
        if self.sky.encode(commands, self.meshes, scene.environment, placement):
            commands.submit()

    @property
    def placement(self) -> Placement:
        """The placement of the lattice that covers the scene."""
        return self.lattices.largest.placement

    @property
    def blockers(self) -> Blockers:
        """The blockers between its cells."""
        return self.lattices.largest.blockers

    def bounds(self, scene: Scene) -> tuple[F64, F64]:
        """What lights must see, metres; from the instances, since a scene's own take a loop."""
        low, high = self.meshes.bounds if self.meshes.draws and not scene.volumes else scene.bounds
        return np.asarray(low, np.float64), np.asarray(high, np.float64)

    def hull(self, low: F64, high: F64) -> Hull:
        """A box around all surfaces, along the lattices' axes; low..high as `bounds`."""
        if self.placement.axes != STRAIGHT:
            low, high = self.meshes.bounds_along(self.placement.axes) or (low, high)
        return triple(low), triple(high)

    @cached_property
    def _hidden(self) -> Hidden:
        return Hidden(self.blockers.rooms)

    def lit(self, scene: Scene) -> Scene:
        """The scene as solvers are given it: lights with extent are samples, hidden ones dark."""
        scene, computes_all = self.emitters.of(scene), self.settings.hidden_lights
        return scene if computes_all else self._hidden.without(scene, self.meshes.current)

    def hidden(self, scene: Scene) -> tuple[bool, ...]:
        """Which lights, and last whether the sky, are dark for the scene's camera."""
        if self.settings.hidden_lights:
            return ()
        return self._hidden.flags(scene, self.meshes.current)

    def encode(self, commands: Commands, scene: Scene, low: F64, high: F64) -> None:
        """Update all that is shared to `scene`; low..high as from `bounds`."""
        # What light must reach, and lattices ahead of the camera; then maps, blockers and the sky.
        self.box = (low, high)
        self.rays.take(scene, low, high)
        self.lattices.follow(scene.camera)
        with commands.stage("shadow maps"):
            self.lights.encode(commands, self.meshes, scene.lights, scene.environment, low, high)
        with commands.stage("blockers"):
            self.lattices.encode(commands, scene)
        with commands.stage("sky"):
            self._light_sky(commands, scene)
        # In the first frame the device does all this while the solvers' kernels are compiled.
        if self._is_first and self.context.commands:
            commands.submit()
        self._is_first = False

    def _light_sky(self, commands: Commands, scene: Scene) -> None:
        """Update the sky's maps, and its light in lattices where it or their blockers changed."""
        # The device draws the maps while the passes that read them are compiled and encoded.
        inner = self.lattices.nest.over_inner
        if self.sky.encode(commands, self.meshes, scene.environment, inner):
            commands.submit()
        for level in self.lattices.levels:
            versions = (self.sky.version, level.blockers.version)
            if level.lit != versions:
                # Blockers that views see change where no lattice moved.
                is_same_sky = level.lit is not None and level.lit[0] == self.sky.version
                is_same = is_same_sky and self.lattices.source is None
                bound = level.blockers.bound
                self.sky.light(commands, level.skylight, bound, is_same_light=is_same)
                level.lit = versions

    def shadow_rays(self, commands: Commands) -> ShadowRays | None:
        """Rays for shadow maps that are unsure, where there are any and the settings want them."""
        # Lights without extent alone have maps that may be unsure.
        if not (self.settings.shadow_rays and self.emitters.plain and self.meshes.draws):
            return None
        return self.rays.shadows(commands)

    @property
    def no_irradiance(self) -> Irradiance:
        """A field without indirect light."""
        # Lattices with black textures.
        rows = [placement.params(1.0) for placement in self.lattices.placements]
        return Irradiance({"lattices": self.lattices.table.filled(rows), **self._black.bound})

    def darkened(self, irradiance: Irradiance) -> Irradiance:
        """A field without indirect light that can be read in the same frame as `irradiance`."""
        return replace(irradiance, bound={**irradiance.bound, **self._black.bound})

    @cached_property
    def _black(self) -> LatticeTextures:
        return LatticeTextures(self.gpu, self.placement, self.lattices.texture_size)

    @property
    def sky_irradiance(self) -> SkyIrradiance:
        """The environment's direct light on surfaces, not attenuated by media."""
        return SkyIrradiance(self.lattices.cube)

    @property
    def stats(self) -> dict[str, Any]:
        """The size of the largest lattice, for --stats."""
        return {"lattice": list(self.placement.count), "iterations": 0}


def scene_nest(scene: Scene, settings: SurfaceSettings, *, in_medium: bool = False) -> Nest:
    """One lattice over the scene, with its medium if `in_medium`, or over the settings' box."""
    # Along the walls, over the scene or the settings' box; a medium far beyond it has one more.
    axes = lattice_axes(scene, follows_walls=settings.follow_walls)
    low, high, resolution = lattice_extent(
        scene, settings.bounds, settings.resolution, in_medium=in_medium, axes=axes
    )
    whole = fitted(low, high, resolution, axes)
    nest = nested(low, high, resolution, whole=whole)
    return with_medium_around(nest, scene, settings.bounds, resolution) if in_medium else nest
