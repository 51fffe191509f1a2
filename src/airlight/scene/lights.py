"""Lights without extent. Directions are travel directions: away from the light."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import SceneError
from . import checks
from .checks import Rgb, Vec3


@dataclass(frozen=True)
class DirectionalLight:
    """Parallel light. `irradiance`: W m^-2 at normal incidence."""

    direction: Vec3
    irradiance: Rgb

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "direction", checks.unit_vec3(self.direction, "light direction"))
        put(self, "irradiance", checks.rgb(self.irradiance, "light irradiance"))


@dataclass(frozen=True)
class PointLight:
    """Light from a point, the same in all directions. `intensity`: W sr^-1."""

    position: Vec3
    intensity: Rgb

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "position", checks.vec3(self.position, "light position"))
        put(self, "intensity", checks.rgb(self.intensity, "light intensity"))


@dataclass(frozen=True)
class SpotLight:
    """A point light within a cone. Half angles; between them the smoothstep of the cosine fades.

    `intensity` on the axis: W sr^-1.
    """

    position: Vec3
    direction: Vec3
    intensity: Rgb
    inner_deg: float = 20.0
    outer_deg: float = 30.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "position", checks.vec3(self.position, "light position"))
        put(self, "direction", checks.unit_vec3(self.direction, "light direction"))
        put(self, "intensity", checks.rgb(self.intensity, "light intensity"))
        put(self, "inner_deg", checks.number(self.inner_deg, "inner_deg", low=0.0, high=89.0))
        put(self, "outer_deg", checks.number(self.outer_deg, "outer_deg", low=0.1, high=89.0))
        if self.inner_deg > self.outer_deg:
            raise SceneError(
                f"inner_deg = {self.inner_deg:g} is above outer_deg = {self.outer_deg:g}"
            )


Light = DirectionalLight | PointLight | SpotLight
