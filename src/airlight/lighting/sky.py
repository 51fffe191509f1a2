"""The environment's light: its occluded direct part on a lattice, and maps for its bounce."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lattice.placement import Placement
from ..lattice.skylight import Skylight
from ..scene.environment import Environment
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views
from ..surface.reflective import ReflectiveShadowMaps
from ..surface.shadow import comparison_sampler
from ..surface.sky import SkyLight, sky_lights


class Sky:
    """Directional lights that stand for the environment, what they see, and what they light.

    `maps` are their reflective shadow maps, whose texels are the sky's first bounce.
    """

    def __init__(
        self, gpu: Gpu, environment: Environment | None, placement: Placement, count: int,
        resolution: int, size: tuple[int, int, int] | None = None,
    ) -> None:  # fmt: skip
        """`count` lights, maps of `resolution` px; `size` as `Skylight` has it."""
        self.placement, self._count = placement, count
        self.lights: list[SkyLight] = sky_lights(environment, count)
        self._environment = environment
        self._drawn_version = -1
        layers = count if self.lights else 0
        self.maps = ReflectiveShadowMaps(gpu, "sky", resolution, layers)
        self.skylight = Skylight(gpu, placement, count, size=size)
        self._compare = comparison_sampler(gpu)

    def encode(
        self, commands: Commands, meshes: GpuScene, environment: Environment | None,
        blockers: Mapping[str, Texture],
    ) -> bool:  # fmt: skip
        """Bring maps and cubes up to date; returns whether anything changed."""
        if environment is not self._environment:
            self._environment = environment
            self.lights = sky_lights(environment, self._count)
            self._drawn_version = -1
        if meshes.version == self._drawn_version or not self.maps.layers:
            return False
        self._drawn_version = meshes.version
        low, high = self.placement.bounds
        # What stands beyond the lattice still casts its shadow into it.
        if meshes.draws:
            low, high = np.minimum(low, meshes.bounds[0]), np.maximum(high, meshes.bounds[1])
        views = light_views(self.lights, low, high, self.maps.resolution)
        self.maps.encode(commands, meshes, self.lights, views)
        self.light(commands, self.skylight, blockers)
        return True

    def light(
        self, commands: Commands, skylight: Skylight, blockers: Mapping[str, Texture], *,
        is_same_light: bool = False,
    ) -> None:  # fmt: skip
        """Fill the cubes of a lattice from the maps as they are.

        `is_same_light`: they did not change, only the lattice's place.
        """
        if self.maps.layers:
            skylight.encode(
                commands, self.lights, self.maps, self._compare, blockers,
                is_same_light=is_same_light,
            )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        self.maps.release()
        self.skylight.release()
