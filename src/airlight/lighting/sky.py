"""The environment as directional lights: their maps, and their light in cells."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lattice.placement import Placement
from ..lattice.skylight import Skylight
from ..scene.environment import Environment
from ..surface.coarse import CoarseScene
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views
from ..surface.reflective import ReflectiveShadowMaps
from ..surface.shadow import comparison_sampler
from ..surface.sky import SkyLight, sky_lights


class Sky:
    """Directional lights that stand for the environment, and their reflective shadow maps.

    `maps` hold which surfaces each light reaches; their texels are the sky's first bounce.
    `version` is raised whenever they are drawn.
    """

    def __init__(
        self, gpu: Gpu, environment: Environment | None, count: int, resolution: int
    ) -> None:
        """At most `count` lights, maps of `resolution` px."""
        self._gpu, self._count = gpu, count
        self.lights: list[SkyLight] = sky_lights(environment, count)
        self._environment = environment
        self._drawn_version = -1
        self.version = 0
        # As many layers as there may ever be lights, if there are any now.
        layers = count if self.lights else 0
        # Cells are as wide as two of their texels or more: 2 by 2 are one virtual point light.
        self.maps = ReflectiveShadowMaps(gpu, "sky", resolution, layers, block=2)
        self._compare = comparison_sampler(gpu)
        self._coarse: CoarseScene | None = None

    def encode(
        self,
        commands: Commands,
        meshes: GpuScene,
        environment: Environment | None,
        placement: Placement,
    ) -> bool:
        """Update the maps for the lattice at `placement`; returns whether anything changed."""
        # Another environment has other lights, whose maps are drawn again.
        if environment is not self._environment:
            self._environment = environment
            self.lights = sky_lights(environment, self._count)
            self._drawn_version = -1
        # The maps depend on the environment and on meshes, not on where the camera looks.
        if meshes.version == self._drawn_version or not self.maps.layers:
            return False
        self._drawn_version = meshes.version
        self.version += 1
        low, high = placement.world_bounds
        # What stands beyond the lattice still casts its shadow into it.
        if meshes.draws:
            low, high = np.minimum(low, meshes.bounds[0]), np.maximum(high, meshes.bounds[1])
        views = light_views(self.lights, low, high, self.maps.resolution)
        self._coarse = self._coarse or CoarseScene(self._gpu, meshes, self.maps.resolution)
        self.maps.encode(commands, self._coarse.current(), self.lights, views)
        return True

    def light(
        self,
        commands: Commands,
        skylight: Skylight,
        blockers: Mapping[str, Texture],
        *,
        is_same_light: bool = False,
    ) -> None:
        """Fill the cubes of a lattice from the maps.

        `is_same_light`: the maps did not change, only the lattice moved.
        """
        if self.maps.layers:
            skylight.encode(
                commands,
                self.lights,
                self.maps,
                self._compare,
                blockers,
                is_same_light=is_same_light,
            )
