"""A point light within a cone that fades towards its border."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from ...errors import SceneError
from ..checks import F32, F64, Rgb, Vec3
from ..keys import within
from .emitters import Colour, Emitter, ImageFile, LookAt
from .light_key import DIRECTION, INTENSITY, POSITION, RADIUS, Control, LightKey
from .light_type import NO_RADIUS_IN_GLTF, LightRow, LightType, Punctual

SPOT_PX = 1024
_NARROWEST = 1e-4  # cosines that the fade spans at least, as in light_kinds.wgsl
_INNER = LightKey(
    "inner_deg", within(0.0, 89.0), "half angle lit in full", "degrees", "20", moves=True
)
_OUTER = LightKey(
    "outer_deg",
    within(0.1, 89.0),
    "half angle of the cone",
    "degrees",
    "30",
    moves=True,
    control=Control("angle", "half angle"),
)


@dataclass(frozen=True)
class SpotLight(LightType):
    """A point light within a cone. Half angles; between them the smoothstep of the cosine fades.

    `intensity` on the axis: W sr^-1. `radius`, metres: of the sphere that the light comes from.
    """

    position: Vec3
    direction: Vec3
    intensity: Rgb
    inner_deg: float = 20.0
    outer_deg: float = 30.0
    radius: float = 0.0

    type_name: ClassVar[str] = "spot"
    kind: ClassVar[int] = 2
    keys: ClassVar[tuple[LightKey, ...]] = (POSITION, DIRECTION, INTENSITY, _INNER, _OUTER, RADIUS)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.inner_deg > self.outer_deg:
            raise SceneError(
                f"inner_deg = {self.inner_deg:g} is above outer_deg = {self.outer_deg:g}"
            )

    def changed(self, name: str, value: Any) -> Self:
        """The light with another value of one field; the inner angle stays inside the outer."""
        if name == "outer_deg":
            return replace(self, outer_deg=value, inner_deg=min(self.inner_deg, value))
        return super().changed(name, value)

    def row(self) -> LightRow:
        """The light as shaders read it; its shape is the cosines of both half angles."""
        inner, outer = (math.cos(math.radians(a)) for a in (self.inner_deg, self.outer_deg))
        return LightRow(self.kind, self.intensity, self.position, self.direction, (inner, outer))

    def sent_share(self, cosine: F64) -> F64:
        """The smoothstep of the cosine between the outer and the inner half angle, in [0, 1]."""
        return spot_share(cosine, self.inner_deg, self.outer_deg)

    @property
    def cone(self) -> tuple[Vec3, float] | None:
        """Its axis, and its half angle in degrees."""
        return self.direction, self.outer_deg

    def most_power(self, cross_section: float) -> float:
        """The most, W, that it sends anywhere."""
        return 2.0 * math.pi * max(self.intensity)

    def emitters(self, notes: list[str]) -> Sequence[Emitter]:
        """A hard cone that projects our fall-off: Mitsuba's own is linear in the angle.

        The image is within 0.5% of the peak at any pair of angles (tested).
        """
        # Mitsuba has no spot light with an extent.
        if self.radius > 0.0:
            notes.append("a spot light's radius: Mitsuba's spots are points, its shadows are hard")
        # The projected texture multiplies a cone without a fall-off; a hard cone needs none.
        inner, outer = self.inner_deg, self.outer_deg
        image = ImageFile(("spot", inner, outer), "spot", lambda: spot_pixels(inner, outer))
        texture = Emitter(
            "texture",
            "bitmap",
            {"filename": image, "raw": True, "wrap_mode": "clamp"},
            name="texture",
            mark=f"airlight_inner_{inner:.9g}",
        )
        return [
            Emitter(
                "emitter",
                "spot",
                {
                    "to_world": _looking(self.position, self.direction),
                    "intensity": Colour(self.intensity),
                    "cutoff_angle": outer,
                    "beam_width": outer,
                },
                inner=() if inner == outer else (texture,),
            )
        ]

    def punctual(self, notes: list[str]) -> Punctual:
        """glTF's own, whose radius is none."""
        if self.radius > 0.0:
            notes.append(NO_RADIUS_IN_GLTF)
        cone = (self.inner_deg, self.outer_deg)
        return Punctual(self.intensity, self.position, self.direction, cone)

    def as_point(self) -> SpotLight:
        """Itself."""
        return self


def spot_share(cosine: F64, inner_deg: float, outer_deg: float) -> F64:
    """The smoothstep of the cosine between the outer and the inner half angle, in [0, 1]."""
    # The fade spans _NARROWEST at least, so that equal angles divide by no zero.
    inner, outer = math.cos(math.radians(inner_deg)), math.cos(math.radians(outer_deg))
    t = np.clip((cosine - outer) / max(inner - outer, _NARROWEST), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def spot_pixels(inner_deg: float, outer_deg: float) -> F32:
    """The fall-off on the plane that Mitsuba projects: (S, S, 3), tan(outer) at the border."""
    # Points of the projection plane at distance 1, and the cosine towards each.
    at = ((np.arange(SPOT_PX) + 0.5) / SPOT_PX * 2.0 - 1.0) * math.tan(math.radians(outer_deg))
    cosine = 1.0 / np.sqrt(1.0 + at[:, None] ** 2 + at[None, :] ** 2)
    falloff = spot_share(cosine, inner_deg, outer_deg).astype(np.float32)
    return np.repeat(falloff[..., None], 3, axis=2)


def _looking(position: Vec3, direction: Vec3) -> LookAt:
    x, y, z = (float(v) for v in np.add(position, direction))
    # Any up that does not lie along the axis.
    up: Vec3 = (0.0, 0.0, 1.0) if abs(direction[1]) > 0.9 else (0.0, 1.0, 0.0)
    return LookAt(position, (x, y, z), up)
