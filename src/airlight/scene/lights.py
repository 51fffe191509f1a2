"""Lights, without extent and with. Directions are travel directions: away from the light.

Each kind without extent says what the passes need that know no kinds: `most_power` bounds its flux
into a box, `half_angle_deg` is the cone that it lights (None: all directions).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

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

    def most_power(self, cross_section: float) -> float:
        """The most, W, of its light that crosses `cross_section`, m^2."""
        return max(self.irradiance) * cross_section


@dataclass(frozen=True)
class PointLight:
    """Light from a point, the same in all directions. `intensity`: W sr^-1.

    `radius`, metres: of the sphere that the light comes from, for soft shadows; it is not seen.
    """

    position: Vec3
    intensity: Rgb
    radius: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "position", checks.vec3(self.position, "light position"))
        put(self, "intensity", checks.rgb(self.intensity, "light intensity"))
        put(self, "radius", checks.number(self.radius, "radius", low=0.0, high=checks.MOST_M))

    def most_power(self, cross_section: float) -> float:
        """The most, W, that it sends anywhere."""
        return 4.0 * math.pi * max(self.intensity)

    @property
    def half_angle_deg(self) -> float | None:
        """None: it sends light in all directions."""
        return None


@dataclass(frozen=True)
class SpotLight:
    """A point light within a cone. Half angles; between them the smoothstep of the cosine fades.

    `intensity` on the axis: W sr^-1. `radius`, metres: of the sphere that the light comes from.
    """

    position: Vec3
    direction: Vec3
    intensity: Rgb
    inner_deg: float = 20.0
    outer_deg: float = 30.0
    radius: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "position", checks.vec3(self.position, "light position"))
        put(self, "direction", checks.unit_vec3(self.direction, "light direction"))
        put(self, "intensity", checks.rgb(self.intensity, "light intensity"))
        put(self, "inner_deg", checks.number(self.inner_deg, "inner_deg", low=0.0, high=89.0))
        put(self, "outer_deg", checks.number(self.outer_deg, "outer_deg", low=0.1, high=89.0))
        put(self, "radius", checks.number(self.radius, "radius", low=0.0, high=checks.MOST_M))
        if self.inner_deg > self.outer_deg:
            raise SceneError(
                f"inner_deg = {self.inner_deg:g} is above outer_deg = {self.outer_deg:g}"
            )

    def most_power(self, cross_section: float) -> float:
        """The most, W, that it sends anywhere."""
        return 2.0 * math.pi * max(self.intensity)

    @property
    def half_angle_deg(self) -> float | None:
        """Half the opening angle of the cone that it lights."""
        return self.outer_deg


AreaShape = Literal["rectangle", "disk", "sphere"]
AREA_SHAPES: tuple[AreaShape, ...] = ("rectangle", "disk", "sphere")


@dataclass(frozen=True)
class AreaLight:
    """A surface that gives light: `radiance`, W m^-2 sr^-1, the same in all directions.

    A "rectangle" of `size` (width, height), metres, a "disk" or a "sphere" of `radius`, metres,
    about `position`. `direction`: of the front's normal; `up` lies in the plane of a rectangle's
    normal and its height. A sphere gives light outwards and has no direction. `two_sided`: the back
    gives light, too. `visible`: whether the surface is seen, and casts shadows. Raises SceneError.
    """

    position: Vec3
    radiance: Rgb
    shape: AreaShape = "rectangle"
    direction: Vec3 = (0.0, -1.0, 0.0)
    up: Vec3 = (0.0, 0.0, -1.0)
    size: tuple[float, float] = (1.0, 1.0)
    radius: float = 0.5
    two_sided: bool = False
    visible: bool = True

    def __post_init__(self) -> None:
        put = object.__setattr__
        if self.shape not in AREA_SHAPES:
            raise SceneError(
                f"area light shape {checks.shown(self.shape)} is unknown",
                remedy=f"It is one of {', '.join(AREA_SHAPES)}.",
            )
        put(self, "position", checks.vec3(self.position, "light position"))
        put(self, "radiance", checks.rgb(self.radiance, "light radiance"))
        put(self, "direction", checks.unit_vec3(self.direction, "light direction"))
        put(self, "up", checks.unit_vec3(self.up, "light up"))
        size = checks.pair(self.size, "light size", low=_LEAST_M, high=checks.MOST_M)
        put(self, "size", size)
        low, high = _LEAST_M, checks.MOST_M
        put(self, "radius", checks.number(self.radius, "light radius", low=low, high=high))
        put(self, "two_sided", checks.boolean(self.two_sided, "two_sided"))
        put(self, "visible", checks.boolean(self.visible, "visible"))

    @property
    def area(self) -> float:
        """Of one side, m^2."""
        if self.shape == "rectangle":
            return self.size[0] * self.size[1]
        return (4.0 if self.shape == "sphere" else 1.0) * math.pi * self.radius**2


_LEAST_M = 1e-6


@dataclass(frozen=True)
class LightSample:
    """A part of a light with extent, seen as one point; the device's own, no scene file has it.

    It sends `intensity` * (`front` * max(c, 0) + `even`), W sr^-1, at the cosine c from
    `direction`. `extent`, metres: how large the part is; nearer than that it gets no brighter.
    `body`, metres: radius of a disk as large as the surface that the light comes from, which
    stands in the way of what is reflected closer to it than `gap`, metres; 0 without one.
    """

    position: Vec3
    direction: Vec3
    intensity: Rgb
    front: float = 1.0
    even: float = 0.0
    extent: float = 0.0
    body: float = 0.0
    gap: float = 0.0

    @property
    def power(self) -> Rgb:
        """W."""
        share = math.pi * (self.front + 4.0 * self.even)
        r, g, b = self.intensity
        return (share * r, share * g, share * b)

    def most_power(self, cross_section: float) -> float:
        """The most, W, that it sends anywhere."""
        return max(self.power)

    @property
    def half_angle_deg(self) -> float | None:
        """None: its shadow map has all directions."""
        return None


LightFromPoint = PointLight | SpotLight | LightSample
"""Lights that shadow maps see from one point."""
Light = DirectionalLight | AreaLight | LightFromPoint
