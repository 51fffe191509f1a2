"""Parallel light, as from far away."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from ..checks import Rgb, Vec3
from ..keys import COLOUR
from .emitters import Colour, Emitter, Vector
from .light_key import DIRECTION, Control, LightKey
from .light_type import LightRow, LightType, Punctual

_IRRADIANCE = LightKey(
    "irradiance",
    COLOUR,
    "irradiance on a surface that faces it",
    "W m^-2",
    required=True,
    stands_for="strength",
    moves=True,
    control=Control("strength", "irradiance (W/m²)"),
)


@dataclass(frozen=True)
class DirectionalLight(LightType):
    """Parallel light. `irradiance`: W m^-2 at normal incidence."""

    direction: Vec3
    irradiance: Rgb

    type_name: ClassVar[str] = "directional"
    kind: ClassVar[int] = 0
    keys: ClassVar[tuple[LightKey, ...]] = (
        replace(DIRECTION, control=Control("sky", "sun")),
        _IRRADIANCE,
    )

    @property
    def noun(self) -> str:
        """Its name in the viewer."""
        return "sun"

    def row(self) -> LightRow:
        """The light as shaders read it."""
        return LightRow(self.kind, self.irradiance, direction=self.direction)

    def most_power(self, cross_section: float) -> float:
        """The most, W, of its light that crosses `cross_section`, m^2."""
        return max(self.irradiance) * cross_section

    def emitters(self, notes: list[str]) -> Sequence[Emitter]:
        """Mitsuba's own."""
        sent, along = Colour(self.irradiance), Vector(self.direction)
        return [Emitter("emitter", "directional", {"direction": along, "irradiance": sent})]

    def punctual(self, notes: list[str]) -> Punctual:
        """glTF's own."""
        return Punctual(self.irradiance, direction=self.direction)
