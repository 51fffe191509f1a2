"""Light from a point, the same in all directions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from ..checks import Rgb, Vec3
from .area import ball
from .emitters import Colour, Emitter, Point
from .light_key import INTENSITY, POSITION, RADIUS, LightKey
from .light_type import NO_RADIUS_IN_GLTF, LightRow, LightType, Punctual


@dataclass(frozen=True)
class PointLight(LightType):
    """Light from a point, the same in all directions. `intensity`: W sr^-1.

    `radius`, metres: of the sphere that the light comes from, for soft shadows; it is not seen.
    """

    position: Vec3
    intensity: Rgb
    radius: float = 0.0

    type_name: ClassVar[str] = "point"
    kind: ClassVar[int] = 1
    keys: ClassVar[tuple[LightKey, ...]] = (POSITION, INTENSITY, RADIUS)

    @property
    def noun(self) -> str:
        """Its name in the viewer."""
        return "lamp"

    def row(self) -> LightRow:
        """The light as shaders read it."""
        return LightRow(self.kind, self.intensity, self.position)

    def most_power(self, cross_section: float) -> float:
        """The most, W, that it sends anywhere."""
        return 4.0 * math.pi * max(self.intensity)

    def emitters(self, notes: list[str]) -> Sequence[Emitter]:
        """Mitsuba's own, or the ball that the light comes from."""
        if self.radius > 0.0:
            return ball(self.position, self.intensity, self.radius).emitters(notes)
        return [point_emitter(self.position, self.intensity)]

    def punctual(self, notes: list[str]) -> Punctual:
        """glTF's own, whose radius is none."""
        if self.radius > 0.0:
            notes.append(NO_RADIUS_IN_GLTF)
        return Punctual(self.intensity, self.position)

    def as_point(self) -> PointLight:
        """Itself."""
        return self


def point_emitter(position: Vec3, intensity: Rgb) -> Emitter:
    """Mitsuba's point light."""
    return Emitter(
        "emitter", "point", {"position": Point(position), "intensity": Colour(intensity)}
    )
