"""One field of a light, described once for scene files, keyframes, the viewer and Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .. import checks
from ..keys import COLOUR, VECTOR, Key, Kind, within

Widget = Literal[
    "point", "choice", "sky", "line", "angle", "length", "lengths", "strength", "colour", "flag"
]
"""How the viewer shows a field, in the order of its panel: a point in space, one of `choices`, a
direction on a map of the sky, a line on it (either of two directions), a half angle in degrees, one
length, two, a colour with its strength, a colour of a surface, yes or no."""


@dataclass(frozen=True)
class Control:
    """A field's control in the viewer."""

    widget: Widget
    label: str
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class LightKey(Key):
    """`stands_for`: what a transform does to it; a strength is never negative.

    `moves`: keyframes may set it, and a renderer follows it; others it is made for. `control`: None
    where the viewer has none.
    """

    stands_for: Literal["number", "point", "direction", "strength"] = "number"
    moves: bool = False
    control: Control | None = None


_TRAVEL = Kind("unit vector (normalised for you)", checks.unit_vec3)

POSITION = LightKey(
    "position",
    VECTOR,
    "where it is",
    "m",
    required=True,
    stands_for="point",
    moves=True,
    control=Control("point", "position (m)"),
)
DIRECTION = LightKey(
    "direction",
    _TRAVEL,
    "of travel: away from the light",
    required=True,
    stands_for="direction",
    moves=True,
)
INTENSITY = LightKey(
    "intensity",
    COLOUR,
    "intensity (of a spot: on its axis)",
    "W sr^-1",
    required=True,
    stands_for="strength",
    moves=True,
    control=Control("strength", "intensity (W/sr)"),
)
RADIUS = LightKey(
    "radius",
    within(0.0, checks.MOST_M),
    "of the sphere it comes from: soft shadows",
    "m",
    "0",
    control=Control("length", "radius (m)"),
)
