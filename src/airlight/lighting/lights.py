"""All lights of a scene on the device: their table, their shadow maps, the environment."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.rows import Table
from ..maths.transforms import F64
from ..scene.environment import Environment
from ..scene.lights import DirectionalLight, Light
from ..surface.geometry import GpuScene
from ..surface.light_table import LightData, packed_lights
from ..surface.light_views import light_views, view_count, widened
from ..surface.shadow import ShadowMaps, affordable_side
from ..surface.sky import EnvironmentTexture

_MOST_TEXELS = 1 << 27  # of shadow maps: 512 MB
TEXEL_BYTES = 8
"""Of a hierarchy over shadow maps, for a texel of theirs (media/shafts/bounds.py)."""


class Lights:
    """Shadow maps and the light table for a fixed set of kinds of lights.

    The number and the kinds of lights are fixed at creation; everything else may change each frame.
    """

    def __init__(
        self,
        gpu: Gpu,
        lights: tuple[Light, ...],
        environment: Environment | None,
        resolutions: tuple[int, int],
        mapped: int | None = None,
        *,
        has_panes: bool = False,
        has_media: bool = False,
    ) -> None:
        """`resolutions`: of maps of directional and of local lights, at most; many have less.

        `mapped`: how many of the lights, the first, have shadow maps; all if not given.
        `has_panes`: whether surfaces tint the light that passes them; `has_media`: whether rays
        through media walk the maps.
        """
        self.gpu = gpu
        # Shadow maps of directional lights and of local ones, a layer for each view.
        self._mapped = len(lights) if mapped is None else mapped
        own = lights[: self._mapped]
        parallel = sum(isinstance(light, DirectionalLight) for light in own)
        local = sum(view_count(x) for x in own if not isinstance(x, DirectionalLight))
        gpu.require(
            "max-texture-array-layers",
            max(parallel, local),
            f"an image with the shadows of {len(own)} lights",
            remedy="Leave lights out, or give them as a group (a light of type 'points')",
        )
        # Those of a kind have room for so much; where rays walk them, their hierarchies do, too.
        most = _MOST_TEXELS
        if has_media:
            most = min(most, gpu.limits["max-storage-buffer-binding-size"] // TEXEL_BYTES)
        sides = [
            affordable_side(asked, layers, most)
            for asked, layers in zip(resolutions, (parallel, local), strict=True)
        ]
        # Maps of both kinds are as large as settings ask, or as there is room for.
        self.parallel = ShadowMaps(
            gpu, "directional shadows", sides[0], parallel, has_panes=has_panes
        )
        self.local = ShadowMaps(gpu, "local shadows", sides[1], local, has_panes=has_panes)
        # The table of all lights, and what lies behind everything.
        self.table = Table(gpu, "lights", LightData, max(1, len(lights)))
        self._environment = environment
        self.background = EnvironmentTexture(gpu, environment)
        self._lights: tuple[Light, ...] | None = None
        self.count = len(lights)
        self.coarseness = 1.0
        """The size of texels of directional lights' shadow maps, over that asked for.

        It is raised while a light is dragged: at 2 a quarter of the map is drawn."""

    def encode(
        self,
        commands: Commands,
        meshes: GpuScene,
        lights: tuple[Light, ...],
        environment: Environment | None,
        low: F64,
        high: F64,
    ) -> None:
        """Update the table, the background and those shadow maps that changed."""
        # What shaders read of lights and background.
        if lights != self._lights:
            self._lights = lights
            self.table.write(packed_lights(lights))
        if environment is not self._environment:
            self._environment = environment
            if not self.background.take(environment):
                self.background.release()
                self.background = EnvironmentTexture(self.gpu, environment)
        # Shadow maps of those views that changed.
        own = lights[: self._mapped]
        directional = [x for x in own if isinstance(x, DirectionalLight)]
        local_lights = [x for x in own if not isinstance(x, DirectionalLight)]
        low, high = np.asarray(low), np.asarray(high)
        views = light_views(directional, low, high, self.parallel.resolution)
        # While a light is dragged, maps of all directional lights are coarse: wider views fill a
        # part of them.
        if self.coarseness != 1.0:
            views = [widened(view, self.coarseness) for view in views]
        self.parallel.encode(commands, meshes, views)
        self.local.encode(
            commands, meshes, light_views(local_lights, low, high, self.local.resolution)
        )

    @property
    def bound(self) -> dict[str, Any]:
        """By slot name, for the lighting pass."""
        return {
            "lights": self.table,
            "parallel_views": self.parallel.views,
            "local_views": self.local.views,
            "parallel_shadows": self.parallel.depth,
            "local_shadows": self.local.depth,
            "parallel_panes": self.parallel.panes.light,
            "local_panes": self.local.panes.light,
            "shadow_compare": self.parallel.sampler,
            "environment": self.background.texture,
            "environment_sampler": self.background.sampler,
        }
