"""Surfaces that give light: rectangles, disks and spheres."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, Self

import numpy as np

from ...maths.sampling import orthonormal_frame
from ...maths.transforms import placed_points
from .. import checks
from ..checks import F64, Rgb, Vec3
from ..keys import BOOLEAN, COLOUR, REFLECTANCE, UNIT_VECTOR, Kind, one_of, within
from .emitters import Colour, Emitter, Point, Value
from .light_key import DIRECTION, POSITION, Control, LightKey
from .light_type import LightRow, LightType

AreaShape = Literal["rectangle", "disk", "sphere"]
AREA_SHAPES: tuple[AreaShape, ...] = ("rectangle", "disk", "sphere")
_LACKS: dict[AreaShape, tuple[str, ...]] = {
    "rectangle": ("radius",),
    "disk": ("size", "up"),
    "sphere": ("size", "up", "two_sided"),
}
_LEAST_M = 1e-6
_CORNERS = 24  # of a circle's outline
_BEHIND = 1e-5  # of the size: how far the back of a two-sided light lies behind its front


def _two_lengths(value: Any, name: str) -> tuple[float, float]:
    return checks.pair(value, name, low=_LEAST_M, high=checks.MOST_M)


_TWO_LENGTHS = Kind("two numbers", _two_lengths)
_KEYS = (
    POSITION,
    LightKey(
        "radiance",
        COLOUR,
        "radiance",
        "W m^-2 sr^-1",
        required=True,
        stands_for="strength",
        moves=True,
        control=Control("strength", "radiance (W/m²/sr)"),
    ),
    LightKey(
        "shape",
        one_of(*AREA_SHAPES),
        "what gives the light; `position` is its middle",
        default='"rectangle"',
        control=Control("choice", "shape", AREA_SHAPES),
    ),
    replace(
        DIRECTION,
        doc="the normal of the side that gives light; not of a sphere",
        default="[0, -1, 0]",
        required=False,
    ),
    LightKey(
        "up",
        UNIT_VECTOR,
        "the direction of a rectangle's height, as far as it lies in its plane",
        default="[0, 0, -1]",
        stands_for="direction",
        moves=True,
        control=Control("line", "height along"),
    ),
    LightKey(
        "size",
        _TWO_LENGTHS,
        "a rectangle's width and height",
        "m",
        "[1, 1]",
        moves=True,
        control=Control("lengths", "size (m)"),
    ),
    LightKey(
        "radius",
        within(_LEAST_M, checks.MOST_M),
        "of a disk or a sphere",
        "m",
        "0.5",
        moves=True,
        control=Control("length", "radius (m)"),
    ),
    LightKey(
        "reflectance",
        REFLECTANCE,
        "of its surface, which is matte, where it is seen",
        default="0",
        control=Control("colour", "reflectance"),
    ),
    LightKey(
        "two_sided",
        BOOLEAN,
        "the back gives light, too",
        default="false",
        control=Control("flag", "both sides give light"),
    ),
    LightKey(
        "visible",
        BOOLEAN,
        "false: it is not seen, and casts no shadow",
        default="true",
        control=Control("flag", "it is seen"),
    ),
)


@dataclass(frozen=True)
class AreaLight(LightType):
    """A surface that gives light: `radiance`, W m^-2 sr^-1, the same in all directions.

    A "rectangle" of `size` (width, height), metres, a "disk" or a "sphere" of `radius`, metres,
    about `position`. `direction`: of the front's normal; `up` lies in the plane of a rectangle's
    normal and its height. A sphere gives light outwards and has no direction. `two_sided`: the back
    gives light, too. `visible`: whether the surface is seen, casts shadows, and reflects as a matte
    surface of that `reflectance`. Raises SceneError.
    """

    position: Vec3
    radiance: Rgb
    shape: AreaShape = "rectangle"
    direction: Vec3 = (0.0, -1.0, 0.0)
    up: Vec3 = (0.0, 0.0, -1.0)
    size: tuple[float, float] = (1.0, 1.0)
    radius: float = 0.5
    reflectance: Rgb = (0.0, 0.0, 0.0)
    two_sided: bool = False
    visible: bool = True

    type_name: ClassVar[str] = "area"
    keys: ClassVar[tuple[LightKey, ...]] = _KEYS
    is_sampled: ClassVar[bool] = True

    @property
    def noun(self) -> str:
        """Its name in the viewer."""
        return self.shape

    @property
    def area(self) -> float:
        """Of one side, m^2."""
        # A sphere gives light from all of its surface, a disk from one side of it.
        if self.shape == "rectangle":
            return self.size[0] * self.size[1]
        return (4.0 if self.shape == "sphere" else 1.0) * math.pi * self.radius**2

    def controls(self) -> list[tuple[LightKey, Control]]:
        """Only what its shape has, and of a surface that is not seen no reflectance."""
        # Controls that change nothing would only be in the way.
        lacks = {*_LACKS[self.shape], *(() if self.visible else ("reflectance",))}
        return [pair for pair in super().controls() if pair[0].name not in lacks]

    @property
    def is_aimed(self) -> bool:
        """Whether it is flat."""
        return self.shape != "sphere"

    def outline(self, eye: Vec3) -> F64 | None:
        """The border of a rectangle or a disk; of a sphere the disk through its middle."""
        # A border of diameter 2 in the plane of the unit shape, closed.
        if self.shape == "rectangle":
            unit = np.array([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), (-1, 0, -1)], float)
        else:
            angle = np.linspace(0.0, 2.0 * np.pi, _CORNERS + 1)
            unit = np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=1)
        # A sphere's outline is that of the disk that faces the eye.
        facing: AreaLight = self
        if self.shape == "sphere" and eye != self.position:
            away = np.subtract(eye, self.position)
            x, y, z = (away / np.linalg.norm(away)).tolist()
            facing = replace(self, shape="disk", direction=(x, y, z))
        # The unit shape's corners, placed.
        placed = world_from_unit(facing)
        corners: F64 = placed_points(0.5 * unit, placed)
        return corners

    def moved(self, matrix: F64) -> Self:
        """The light through a (4, 4) matrix; its surface grows with the rest."""
        # Scales that differ by axis have no equal among these shapes: their mean keeps the volume.
        scale = float(np.cbrt(abs(np.linalg.det(matrix[:3, :3])))) or 1.0
        width, height = self.size
        moved = super().moved(matrix)
        return replace(moved, size=(scale * width, scale * height), radius=scale * self.radius)

    def row(self) -> LightRow:
        """None of its light: samples of it have rows of their own."""
        return LightRow(0, (0.0, 0.0, 0.0))

    def most_power(self, cross_section: float) -> float:
        """None: its samples are counted."""
        return 0.0

    def emitters(self, notes: list[str]) -> Sequence[Emitter]:
        """A matte shape with an area emitter; the back of a two-sided one is its own shape."""
        # Mitsuba's area emitters are surfaces, and a surface is seen.
        if not self.visible:
            notes.append("a light that is not seen: Mitsuba shows it, and it casts shadows")
        sides = (1.0, -1.0) if self.two_sided and self.shape != "sphere" else (1.0,)
        return [self._side(side) for side in sides]

    def _side(self, side: float) -> Emitter:
        light = Emitter("emitter", "area", {"radiance": Colour(self.radiance)})
        matte = Emitter("bsdf", "diffuse", {"reflectance": Colour(self.reflectance)})
        mark = light_mark(is_back=side < 0.0, is_seen=self.visible, is_two_sided=self.two_sided)
        if self.shape == "sphere":
            ball: dict[str, Value] = {"center": Point(self.position), "radius": self.radius}
            return Emitter("shape", "sphere", ball, (light, matte), mark=mark)
        # Mitsuba's are 2 m across and face +z; ours are 1 m across and face +y.
        unit = world_from_unit(self)
        placed = np.eye(4)
        placed[:3, 0], placed[:3, 1] = 0.5 * side * unit[:3, 2], 0.5 * unit[:3, 0]
        placed[:3, 2], placed[:3, 3] = side * unit[:3, 1], unit[:3, 3]
        # The back of a light lies a hair behind its front, so that neither shadows the other.
        placed[:3, 3] += min(side, 0.0) * _BEHIND * max(self.size) * unit[:3, 1]
        return Emitter("shape", self.shape, {"to_world": placed}, (light, matte), mark=mark)

    def punctual(self, notes: list[str]) -> None:
        """None: where it is seen it is an emissive mesh."""
        if not self.visible:
            notes.append("a light with extent that is not seen has no place in glTF")


_MARK = "airlight_light"


def light_mark(*, is_back: bool, is_seen: bool, is_two_sided: bool) -> str:
    """The beginning of a shape's id, by which reading it knows what Mitsuba cannot say."""
    # Words in one order, so that a mark can be searched for each.
    words = [
        *(["back"] if is_back else []),
        *(["two_sided"] if is_two_sided else []),
        *(["unseen"] if not is_seen else []),
    ]
    return "_".join([_MARK, *words])


def world_from_unit(light: AreaLight) -> F64:
    """The placement (4, 4) of a surface that is 1 m across: its +Y along the light's direction."""
    placed = np.eye(4)
    placed[:3, 3] = light.position
    if light.shape == "sphere":
        placed[:3, :3] *= 2.0 * light.radius
        return placed
    # The height within the plane of the surface; any will do where `up` lies along the normal.
    normal = np.array(light.direction)
    height = np.array(light.up) - np.dot(light.up, normal) * normal
    length = float(np.linalg.norm(height))
    height = height / length if length > 1e-6 else orthonormal_frame(normal)[1]
    width = np.cross(height, normal)
    across, along = light.size if light.shape == "rectangle" else (2.0 * light.radius,) * 2
    # Columns: the quad's x, its normal, its z; right-handed.
    placed[:3, :3] = np.stack([across * -width, normal, along * height], axis=1)
    return placed


def ball(position: Vec3, intensity: Rgb, radius: float) -> AreaLight:
    """The sphere, not seen, that gives an intensity, W sr^-1: radiance times its cross section."""
    r, g, b = (c / (math.pi * radius**2) for c in intensity)
    return AreaLight(position, (r, g, b), "sphere", radius=radius, visible=False)
