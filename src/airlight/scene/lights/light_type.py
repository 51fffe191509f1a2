"""What a type of light says of itself. No other module asks which type a light is of.

fields       `keys`: scene files, keyframes, the viewer and the checks of Python's own lights
viewer       `controls`, `is_aimed`, `outline`
device       `row`, and `sent_share`: the twin of lights.wgsl's
shadows      `cone`, `unshadowed_m`; `is_sampled` where samples of it have the shadow maps
bounds       `most_power`
others       `moved` by a transform, `emitters` for Mitsuba, `punctual` for glTF, `as_point` for
             principal ordinates
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self, get_args

import numpy as np

from ..checks import F64, Rgb, Vec3
from ..placing import moved_point, moved_vector
from .emitters import Emitter
from .light_key import Control, LightKey, Widget

if TYPE_CHECKING:
    from .point import PointLight
    from .spot import SpotLight


@dataclass(frozen=True)
class LightRow:
    """A light as shaders read it. `color`: W m^-2 of a directional light, W sr^-1 of others.

    `shape`: two numbers that the type's `sent_share` reads. `nearest`, m^2: squares of distances
    are no smaller. `body`, m^2, `gap`, m, `tangent`, `size`, m, `inner_depth` and
    `spread`, m: as of `LightSample`, the body squared.
    """

    kind: int
    color: Rgb
    position: Vec3 = (0.0, 0.0, 0.0)
    direction: Vec3 = (0.0, -1.0, 0.0)
    shape: tuple[float, float] = (-1.0, -1.0)
    nearest: float = 1e-16
    body: float = 0.0
    gap: float = 0.0
    tangent: Vec3 = (1.0, 0.0, 0.0)
    size: tuple[float, float] = (0.0, 0.0)
    inner_depth: Rgb = (0.0, 0.0, 0.0)
    spread: float = 0.0


NO_RADIUS_IN_GLTF = "a light's radius: glTF's lights are points, their shadows are hard"


@dataclass(frozen=True)
class Punctual:
    """A light as glTF's KHR_lights_punctual has it, whose type has the same name.

    `strength`: W m^-2 of a directional light, W sr^-1 of others; `cone_deg`: inner and outer half
    angle of a spot.
    """

    strength: Rgb
    position: Vec3 = (0.0, 0.0, 0.0)
    direction: Vec3 = (0.0, 0.0, -1.0)
    cone_deg: tuple[float, float] | None = None


@dataclass(frozen=True)
class LightType:
    """Base of all types; fields are those that `keys` describes, which also checks them."""

    called: ClassVar[str] = "Light"
    """In messages about what is no light."""
    type_name: ClassVar[str] = ""
    """In scene files; empty for what no scene file has."""
    kind: ClassVar[int]
    """`LightData.kind`: a constant of lights.wgsl."""
    keys: ClassVar[tuple[LightKey, ...]] = ()
    has_size: ClassVar[bool] = False
    """Whether media may see it as large as it is (`LightRow.size`), and not as a point."""
    is_sampled: ClassVar[bool] = False
    """Whether only samples of it reach the device, with views and rows of their own."""

    def __post_init__(self) -> None:
        # The check of each field is the one that scene files have.
        for key in self.keys:
            checked = key.kind.check(getattr(self, key.name), f"light {key.name}")
            object.__setattr__(self, key.name, checked)

    @property
    def noun(self) -> str:
        """Its name in the viewer."""
        return self.type_name

    @classmethod
    def strength_name(cls) -> str:
        """The field that says how bright it is."""
        return next(key.name for key in cls.keys if key.stands_for == "strength")

    def darkened(self) -> Self:
        """The same light, which gives nothing."""
        return replace(self, **{self.strength_name(): (0.0, 0.0, 0.0)})

    @property
    def fixed(self) -> tuple[Any, ...]:
        """What a renderer is made for and cannot follow: its type, and what does not move."""
        own = (getattr(self, key.name) for key in self.keys if not key.moves)
        return (self.type_name, *own)

    def controls(self) -> list[tuple[LightKey, Control]]:
        """The fields that the viewer offers, with their controls, in the order of `Widget`."""
        # Fields of one kind of widget keep the order of `keys`.
        shown = [(key, key.control) for key in self.keys if key.control is not None]
        order = get_args(Widget)
        return sorted(shown, key=lambda pair: order.index(pair[1].widget))

    @property
    def is_aimed(self) -> bool:
        """Whether it has a direction that can be chosen."""
        return any(key.name == "direction" for key in self.keys)

    def outline(self, eye: Vec3) -> F64 | None:
        """Corners (N, 3), metres, of the border that `eye` sees; None for lights without one."""
        del eye
        return None

    def changed(self, name: str, value: Any) -> Self:
        """The light with another value of one field, and of what must change with it."""
        return replace(self, **{name: value})

    def moved(self, matrix: F64) -> Self:
        """The light through a (4, 4) matrix; its strength stays."""
        by_meaning = {"point": moved_point, "direction": moved_vector}
        changes: dict[str, Any] = {
            key.name: by_meaning[key.stands_for](getattr(self, key.name), matrix)
            for key in self.keys
            if key.stands_for in by_meaning
        }
        return replace(self, **changes)

    def row(self) -> LightRow:
        """The light as shaders read it."""
        raise NotImplementedError

    def sent_share(self, cosine: F64) -> F64:
        """The share of its strength that it sends at a cosine from its direction."""
        return np.ones_like(cosine)

    @property
    def unshadowed_m(self) -> Vec3:
        """Metres along x, y and z: what is nearer casts no shadow in its light."""
        return (0.0, 0.0, 0.0)

    @property
    def cone(self) -> tuple[Vec3, float] | None:
        """(axis, half angle in degrees) of the directions that it lights; None for all."""
        return None

    def most_power(self, cross_section: float) -> float:
        """The most, W, of its light that crosses `cross_section`, m^2."""
        raise NotImplementedError

    def emitters(self, notes: list[str]) -> Sequence[Emitter]:
        """The light in Mitsuba's terms; what Mitsuba cannot do is added to `notes`."""
        raise NotImplementedError

    def punctual(self, notes: list[str]) -> Punctual | None:
        """The light in glTF's terms, None where it has none; what is lost is added to `notes`."""
        del notes
        return None

    def as_point(self) -> PointLight | SpotLight | None:
        """The light as principal ordinates know local ones; None for a distant or sampled one."""
        return None
