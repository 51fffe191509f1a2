"""Lights in the image: marks that show where they are, and handles to move and turn them by.

The marks are lines and dots in logical pixels, which the window and the page draw each in its own
way; what a hand does to them is decided here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ...maths.transforms import F64, triple
from ...scene.lights import Light
from .controls import LEFT
from .projection import Projection
from .state import ViewState

Colour = tuple[float, float, float]
_GOLD, _PALE = (0.94, 0.71, 0.33), (0.85, 0.85, 0.80)
_AXES: tuple[tuple[F64, Colour], ...] = (
    (np.array([1.0, 0.0, 0.0]), (0.93, 0.36, 0.32)),
    (np.array([0.0, 1.0, 0.0]), (0.46, 0.80, 0.36)),
    (np.array([0.0, 0.0, 1.0]), (0.36, 0.58, 0.96)),
)
_ARM_PX, _AIM_PX = 56.0, 84.0
_REACH_PX, _SPLIT_REACH_PX = 11.0, 9.0

Part = Literal["light", "axis", "aim"]


@dataclass(frozen=True)
class Mark:
    """A dot (its radius is `width`) or a line through `points`, logical pixels of the image; or
    `text` whose base line begins at a point, or `ends_here`, in letters of `width`.
    """

    kind: Literal["dot", "line", "text"]
    points: tuple[tuple[float, float], ...]
    colour: Colour
    width: float
    text: str = ""
    ends_here: bool = False


@dataclass(frozen=True, eq=False)
class Handle:
    """What a hand can take: a light itself, one of its arrows (`axis`), or the dot that aims it."""

    part: Part
    light: int
    at: F64
    axis: int = 0


class Grips:
    """`handle` events before the camera has them; `marks` of what can be taken.

    A light shows its handles once it was picked. What is not `is_shown` cannot be taken.
    """

    def __init__(self, state: ViewState) -> None:
        self.state, self.is_shown = state, True
        self._held: Callable[[Projection, float, float], None] | None = None
        self._at = (0.0, 0.0)

    @property
    def is_held(self) -> bool:
        """Whether a hand has one."""
        return self._held is not None

    def handle(self, event: Mapping[str, Any], seen: Projection) -> bool:
        """Take an event, its place in the image's logical pixels; true where it was for these."""
        # A plain press of the left button may take a handle.
        kind = event["event_type"]
        if kind == "pointer_down" and event["button"] == LEFT and not event.get("modifiers"):
            self._at = event["x"], event["y"]
            self._held = self._taken(seen, *self._at)
            return self._held is not None
        # While something is held all moves are its own.
        if self._held is None:
            return False
        if kind in ("pointer_move", "pointer_up"):
            # A quick hand's last moves may be lost, and only where it lets go is known.
            at = event.get("x", self._at[0]), event.get("y", self._at[1])
            if at != self._at:
                self._at = at
                self._held(seen, *at)
            self._held = None if kind == "pointer_up" else self._held
            return True
        return False

    def release(self) -> None:
        """Forget what is held: the window lost the hand."""
        self._held = None

    def marks(self, seen: Projection) -> tuple[Mark, ...]:
        """All lights; of the chosen one its outline and its handles."""
        lights = self.state.scene.lights if self.is_shown else ()
        found: list[Mark] = []
        for index, light in enumerate(lights):
            at = place(light, seen)
            # A light behind the eye has no mark.
            if at is None:
                continue
            is_chosen = index == self.state.picked
            if is_chosen:
                found += _outline(light, seen)
                found += _arms(light, seen, at)
            colour = _GOLD if is_chosen else _PALE
            found.append(Mark("dot", (_pair(at),), colour, 6.0 if is_chosen else 4.0))
        return tuple(found)

    def _taken(
        self, seen: Projection, x: float, y: float
    ) -> Callable[[Projection, float, float], None] | None:
        """What a press at a pixel takes: the nearest handle, else the line between two images."""
        lights = self.state.scene.lights if self.is_shown else ()
        # Every handle by its distance from the press.
        near = [
            (float(np.hypot(*(handle.at - (x, y)))), handle)
            for handle in handles(lights, self.state.picked, seen)
        ]
        # Beside all handles a press may still take the line between two images.
        distance, handle = min(near, key=lambda pair: pair[0], default=(np.inf, None))
        if handle is None or distance > _REACH_PX:
            return self._divided if self._is_line(seen, x) else None
        self.state.light = self.state.picked = handle.light
        return _Hold(self.state, handle, seen, (x, y)).to

    def over_line(self, seen: Projection, x: float) -> bool:
        """Whether a hand at a pixel has, or would take, the line between two images."""
        is_free = self._held is None and self._is_line(seen, x)
        return is_free or self._held == self._divided

    def _is_line(self, seen: Projection, x: float) -> bool:
        line = self.state.split * seen.size[0]
        return bool(self.state.compared) and abs(x - line) <= _SPLIT_REACH_PX

    def _divided(self, seen: Projection, x: float, y: float) -> None:
        del y
        self.state.split = float(np.clip(x / seen.size[0], 0.02, 0.98))


class _Hold:
    """A handle in a hand, from where it was taken; the light follows the hand."""

    def __init__(
        self, state: ViewState, handle: Handle, seen: Projection, at: tuple[float, float]
    ) -> None:
        self.state, self.part = state, handle.part
        self.index, self.light = handle.light, state.scene.lights[handle.light]
        self.axis = _AXES[handle.axis][0]
        # The hand need not have met the handle's middle.
        self.off = handle.at - at
        self.begun_m = self._along(seen, *handle.at) if handle.part == "axis" else None

    def to(self, seen: Projection, x: float, y: float) -> None:
        """The hand is at a pixel now."""
        x, y = x + self.off[0], y + self.off[1]
        changed = self._turned(seen, x, y) if self.part == "aim" else self._moved(seen, x, y)
        if changed is not None:
            self.state.set_light(self.index, changed)

    def _moved(self, seen: Projection, x: float, y: float) -> Light | None:
        # A hand moves lights by their meaning: directions, one axis, or a plane.
        light = self.light
        position = position_of(light)
        if position is None:  # infinitely far: it comes from where the hand is
            return light.changed("direction", triple(-seen.ray(x, y)))
        # Along one axis: by as much as the hand has moved along it since the press.
        if self.part == "axis":
            now, begun = self._along(seen, x, y), self.begun_m
            if now is None or begun is None:
                return None
            return light.changed("position", triple(position + (now - begun) * self.axis))
        # Freely: in the plane through the light that faces the camera.
        forward = np.subtract(seen.camera.target, seen.camera.position)
        there = seen.on_plane(x, y, position, forward / np.linalg.norm(forward))
        return None if there is None else light.changed("position", triple(there))

    def _along(self, seen: Projection, x: float, y: float) -> float | None:
        position = position_of(self.light)
        return None if position is None else seen.along(x, y, position, self.axis)

    def _turned(self, seen: Projection, x: float, y: float) -> Light | None:
        """The light looks along the sphere about it that the hand is on, on the nearer half."""
        position = position_of(self.light)
        if position is None:
            return None
        # A sphere about the light, as wide on the image at every distance.
        radius = _AIM_PX * seen.pixel_m(position)
        eye, ray = np.array(seen.camera.position), seen.ray(x, y)
        away = position - eye
        nearest = float(ray @ away)
        missed = away - nearest * ray  # from the ray to the light
        gap = float(np.linalg.norm(missed))
        # Where the hand's ray meets it, on the half that the light already points to; beside it,
        # the rim.
        depth = float(np.sqrt(max(radius * radius - gap * gap, 0.0)))
        side = -1.0 if np.dot(direction_of(self.light), away) < 0.0 else 1.0
        towards = -missed + side * depth * ray
        return self.light.changed("direction", triple(towards / np.linalg.norm(towards)))


def position_of(light: Light) -> F64 | None:
    """Where a light is, metres; None for one that is infinitely far."""
    at = getattr(light, "position", None)
    return None if at is None else np.array(at)


def direction_of(light: Light) -> F64:
    """Where it shines to; of one that has no direction, downwards."""
    return np.array(getattr(light, "direction", (0.0, -1.0, 0.0)))


def place(light: Light, seen: Projection) -> F64 | None:
    """The pixel of a light, or of the sky that it comes from; None behind the eye."""
    at = position_of(light)
    return seen.towards(-direction_of(light)) if at is None else seen.pixel(at)


def handles(lights: tuple[Light, ...], chosen: int, seen: Projection) -> Iterator[Handle]:
    """All that can be taken in the image."""
    for index, light in enumerate(lights):
        at = place(light, seen)
        if at is None:
            continue
        yield Handle("light", index, at)
        if index != chosen:
            continue
        # The chosen light's arrows and aim, unless they would cover its own dot.
        for axis, end in enumerate(_arm_ends(light, seen)):
            if end is not None and np.hypot(*(end - at)) > _REACH_PX:
                yield Handle("axis", index, end, axis)
        aim = _aim(light, seen)
        if aim is not None and np.hypot(*(aim - at)) > 0.5 * _REACH_PX:
            yield Handle("aim", index, aim)


def _arm_ends(light: Light, seen: Projection) -> list[F64 | None]:
    position = position_of(light)
    if position is None:
        return []
    length = _ARM_PX * seen.pixel_m(position)
    return [seen.pixel(position + length * axis) for axis, _ in _AXES]


def _aim(light: Light, seen: Projection) -> F64 | None:
    position = position_of(light)
    if position is None or not light.is_aimed:
        return None
    # The aim is a dot ahead of the light, as far on the image at every distance.
    return seen.pixel(position + _AIM_PX * seen.pixel_m(position) * direction_of(light))


def _arms(light: Light, seen: Projection, at: F64) -> Iterator[Mark]:
    """The arrows of a light that is somewhere, and the line along which it shines."""
    for (_, colour), end in zip(_AXES, _arm_ends(light, seen), strict=False):
        if end is not None and np.hypot(*(end - at)) > _REACH_PX:
            yield Mark("line", (_pair(at), _pair(end)), colour, 2.0)
            yield Mark("dot", (_pair(end),), colour, 4.5)
    aim = _aim(light, seen)
    if aim is not None:
        yield Mark("line", (_pair(at), _pair(aim)), _GOLD, 1.5)
        yield Mark("dot", (_pair(aim),), _GOLD, 4.5)


def _outline(light: Light, seen: Projection) -> Iterator[Mark]:
    """The border of a surface that shines."""
    border = light.outline(seen.camera.position)
    pixels = [] if border is None else [seen.pixel(corner) for corner in border]
    # A border that is partly behind the eye is not drawn.
    if pixels and all(pixel is not None for pixel in pixels):
        yield Mark("line", tuple(_pair(p) for p in pixels if p is not None), _GOLD, 1.5)


def _pair(at: F64) -> tuple[float, float]:
    return round(float(at[0]), 1), round(float(at[1]), 1)
