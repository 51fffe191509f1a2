"""Directional lights and the environment as ordinates, in the world (Elek2014 section 5.1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...maths.ordinates import (
    Ordinates,
    importance_sampled,
    joined,
    parallel,
    partition,
    uniform_sky,
)
from ...maths.transforms import F64
from ...maths.view_ordinates import view_partition, view_samples
from ...scene.environment import Environment
from ...scene.lights import DirectionalLight, Light
from ...surface.sky import environment_map
from .sky_correction import SkyLight
from .table import LocalLight

# A sky of radiance 1 everywhere; its number of texels does not matter.
_UNIFORM = np.ones((2, 4, 3))
MAKERS: dict[str, Callable[[F64, int], Ordinates]] = {
    "partition": partition,
    "importance": importance_sampled,
}
"""By the names of the setting: how an environment map becomes ordinates."""
# The same makers where an importance says which directions the camera sees.
_FOR_VIEW = {"partition": view_partition, "importance": view_samples}


class SceneOrdinates:
    """Directional lights and environment as ordinates, computed where they changed.

    A rotated environment rotates its ordinates: they are computed in the frame of the map, so that
    nothing flickers while it rotates. The camera matters only where `of` gets an importance.
    """

    def __init__(self, count: int, made_by: str = "partition") -> None:
        """At most `count` ordinates of the environment; `made_by` is one of `MAKERS`."""
        self.count, self._maker, self._for_view = count, MAKERS[made_by], _FOR_VIEW[made_by]
        self._importance: F64 | None = None
        self._made_for: F64 | None = None
        self._environment: Environment | None = None
        self._sky: Ordinates | None = None
        self._made: tuple[Environment, SkyLight | None] | None = None
        self.sky: SkyLight | None = None
        """The map of the last frame and its ordinates, before they are rotated."""

    def of(
        self,
        lights: tuple[Light, ...],
        environment: Environment | None,
        importance: F64 | None = None,
    ) -> Ordinates:
        """The ordinates of all directional lights, then of the environment; none if it is black.

        `importance` (h, w) by direction towards the map, before it is rotated.
        """
        parts = []
        # A directional light is an ordinate of its own.
        distant = [light for light in lights if isinstance(light, DirectionalLight)]
        if distant:
            parts.append(parallel([x.direction for x in distant], [x.irradiance for x in distant]))
        # The environment's are computed again where it or the importance for the view changed.
        if environment is not self._environment or importance is not self._importance:
            self._environment, self._importance = environment, importance
            self._sky = self._of_sky(environment)
        if self._sky is not None:
            parts.append(self._sky)
        return joined(parts) if parts else parallel(np.zeros((0, 3)), np.zeros((0, 3)))

    def _of_sky(self, environment: Environment | None) -> Ordinates | None:
        """The ordinates of an environment, rotated as it is."""
        if environment is None or self.count < 1:
            return None
        if environment.map is None:
            return self._of_uniform(environment)
        # Compute them where the map or the view is another one.
        view = self._importance
        if self._made is None or not _is_same_map(self._made[0], environment):
            radiance = environment_map(environment)
            has_light = radiance.max() > 0.0
            self._made = environment, self._computed(radiance, view) if has_light else None
        elif self._made_for is not view and self._made[1] is not None:
            self._made = environment, self._computed(self._made[1].radiance, view)
        self._made_for = view
        if self._made[1] is None:
            return None
        # Rotate them with the environment.
        self.sky = replace(self._made[1], rotation_deg=environment.rotation_deg)
        angle = np.radians(environment.rotation_deg)
        c, s = np.cos(angle), np.sin(angle)
        about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        return self.sky.ordinates.turned(about_y)

    def _of_uniform(self, environment: Environment) -> Ordinates | None:
        """Those of a uniform sky, which are those of the furnace correction: its error vanishes."""
        # The ordinates of radiance 1 serve every uniform sky.
        uniform = uniform_sky(self.count)
        light = np.asarray(environment.radiance) * environment.scale
        self.sky = uniform_light(uniform)
        return replace(uniform, irradiance=uniform.irradiance * light) if light.any() else None

    def _computed(self, radiance: F64, importance: F64 | None) -> SkyLight:
        if importance is None:
            return SkyLight(radiance, self._maker(radiance, self.count))
        return SkyLight(radiance, self._for_view(radiance, self.count, importance))


def uniform_light(uniform: Ordinates) -> SkyLight:
    """A sky of radiance 1 everywhere, with its ordinates."""
    return SkyLight(_UNIFORM, uniform)


def _is_same_map(one: Environment, other: Environment) -> bool:
    return one.map is other.map and one.scale == other.scale


def local_lights(lights: tuple[Light, ...]) -> list[LocalLight]:
    """The point and spot lights of a scene, and points of lights with extent as such."""
    return [point for light in lights if (point := light.as_point()) is not None]
