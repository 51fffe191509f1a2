"""A part of a light with extent, seen as one point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..checks import F64, Rgb, Vec3
from .light_type import LightRow, LightType
from .point import PointLight
from .spot import SpotLight


@dataclass(frozen=True)
class LightSample(LightType):
    """A part of a light with extent, seen as one point; the device's own, no scene file has it.

    It sends `intensity` * (`front` * max(c, 0) + `even`), W sr^-1, at the cosine c from
    `direction`. `extent`, metres: how large the part is; nearer than that it gets no brighter.
    `size`, metres, as media near it see it: of a rectangle half its sides, along `tangent` and
    across, or the radius of a ball and 0; both 0: as a point. `near`, metres along x, y and z: what
    is nearer, the surface itself, does not shadow it. `spread`, metres: the root mean square
    distance from the middle of a part that fills a volume; `inner_depth`: that as an optical depth.
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
    tangent: Vec3 = (1.0, 0.0, 0.0)
    size: tuple[float, float] = (0.0, 0.0)
    near: Vec3 = (0.0, 0.0, 0.0)
    spread: float = 0.0
    inner_depth: Rgb = (0.0, 0.0, 0.0)

    kind: ClassVar[int] = 3
    has_size: ClassVar[bool] = True

    @classmethod
    def strength_name(cls) -> str:
        """It has no keys to look it up in."""
        return "intensity"

    @property
    def power(self) -> Rgb:
        """W."""
        # Pi times the front's share for a cosine over the hemisphere, 4 pi for all directions.
        share = math.pi * (self.front + 4.0 * self.even)
        r, g, b = self.intensity
        return (share * r, share * g, share * b)

    @property
    def unshadowed_m(self) -> Vec3:
        """Its own surface is no farther."""
        return self.near

    def row(self) -> LightRow:
        """The light as shaders read it; its shape is `front` and `even`."""
        return LightRow(
            self.kind,
            self.intensity,
            self.position,
            self.direction,
            (self.front, self.even),
            max(self.extent**2, 1e-8),
            self.body**2,
            self.gap,
            self.tangent,
            self.size,
            self.inner_depth,
            self.spread,
        )

    def sent_share(self, cosine: F64) -> F64:
        """By the cosine, and to all sides."""
        return np.asarray(self.front * np.maximum(cosine, 0.0) + self.even)

    def most_power(self, cross_section: float) -> float:
        """The most, W, that it sends anywhere."""
        return max(self.power)

    def as_point(self) -> PointLight | SpotLight:
        """A spot over the hemisphere, whose smoothstep carries the power of a cosine.

        That is pi times the intensity; what sends to all sides is a point of the same power.
        """
        if self.even == 0.0:
            return SpotLight(self.position, self.direction, self.intensity, 0.0, 89.0)
        r, g, b = (power / (4.0 * math.pi) for power in self.power)
        return PointLight(self.position, (r, g, b), self.spread)
