"""From mouse and keys to a camera: orbit around what is looked at, or fly.

orbit   left drag turns, right or shift-left drag moves, wheel comes nearer; in a room walls hold
        the eye
fly     left drag looks around; w a s d q e move in both, shift faster
sun     control-left drag, or l held, turns the chosen light
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...maths.transforms import F64, triple
from ...scene.camera import Camera, axes
from ...scene.checks import Vec3
from ...scene.placing import shifted
from .free_space import FreeSpace

LEFT, RIGHT, MIDDLE = 1, 2, 3
_TURN_DEG_PER_SIDE = 180.0  # a drag across the image's height turns half around
_STEEPEST_DEG = 89.0
_NEARER_PER_NOTCH = 0.88
_FASTER = 4.0
_REACH_PER_S = 0.12  # of the scene's size that flying covers in a second
_MOVES: dict[str, tuple[int, int, int]] = {  # right, up, forward
    "w": (0, 0, 1),
    "s": (0, 0, -1),
    "a": (-1, 0, 0),
    "d": (1, 0, 0),
    "q": (0, -1, 0),
    "e": (0, 1, 0),
    "ArrowUp": (0, 0, 1),
    "ArrowDown": (0, 0, -1),
    "ArrowLeft": (-1, 0, 0),
    "ArrowRight": (1, 0, 0),
}


@dataclass(frozen=True)
class Turn:
    """A wish to turn the chosen light: about +Y, and up, degrees."""

    azimuth_deg: float
    elevation_deg: float


class CameraControls:
    """Events in, `camera` out. `reach_m` is the scene's size; `home` what `reset` returns to.

    `free` says what is in the eye's way, None that nothing is.
    """

    def __init__(self, camera: Camera, reach_m: float, free: FreeSpace | None = None) -> None:
        self.camera = self.home = camera
        self.free = free
        self.reach_m = max(reach_m, 1e-3)
        self.is_flying = False
        self.height_px = 1.0
        self.turn = Turn(0.0, 0.0)
        self._button = 0
        self._at = (0.0, 0.0)
        self._keys: set[str] = set()
        self._arm_m: float | None = None  # of the orbit that a drag began; None before it moves

    @property
    def is_held(self) -> bool:
        """Whether a mouse button or a key that moves is down: more change is to be expected."""
        return bool(self._button) or self.is_moving

    @property
    def is_moving(self) -> bool:
        """Whether keys are held that `advance` moves by."""
        return any(key in _MOVES for key in self._keys)

    def reset(self) -> None:
        """Back to the scene's own camera."""
        self.camera = self.home

    def handle(self, event: Mapping[str, Any]) -> None:
        """Take one event of a rendercanvas canvas; unknown ones do nothing."""
        does = {
            "pointer_down": self._down,
            "pointer_up": self._up,
            "pointer_move": self._move,
            "wheel": self._wheel,
            "key_down": self._key_down,
            "key_up": self._key_up,
        }.get(event["event_type"])
        if does:
            does(event)

    def release(self) -> None:
        """Forget held buttons and keys: the window lost them."""
        self._button = 0
        self._keys.clear()

    def advance(self, seconds: float) -> None:
        """Fly on for `seconds` by the keys that are held."""
        # Moves of all held keys add up.
        moves = [_MOVES[key] for key in self._keys if key in _MOVES]
        if not moves:
            return
        speed = _REACH_PER_S * self.reach_m * (_FASTER if "Shift" in self._keys else 1.0)
        right, _, forward = axes(self.camera)
        # Along the image's right, the world's up, and the view.
        x, y, z = np.sum(moves, axis=0)
        along = x * right + y * np.asarray(self.camera.up) + z * forward
        # A frame that took long must not throw the camera out of the room.
        self._shift(along * speed * min(seconds, 0.25))

    def pinch(self, dx: float, dy: float, scale: float) -> None:
        """Two fingers went along by pixels, and `scale` times as far apart."""
        # Fingers that go apart are notches of a wheel.
        self._pan(dx, dy)
        notches = float(np.log(scale) / np.log(_NEARER_PER_NOTCH))
        self._wheel({"dy": 100.0 * notches})

    def take_turn(self) -> Turn:
        """What the light was turned by since the last call."""
        turn, self.turn = self.turn, Turn(0.0, 0.0)
        return turn

    def _down(self, event: Mapping[str, Any]) -> None:
        self._button = int(event["button"])
        self._at = (event["x"], event["y"])
        self._arm_m = None

    def _up(self, event: Mapping[str, Any]) -> None:
        self._button = 0

    def _move(self, event: Mapping[str, Any]) -> None:
        if not self._button:
            return
        x, y = event["x"], event["y"]
        # By how much the pointer went since the last event.
        dx, dy = x - self._at[0], y - self._at[1]
        self._at = (x, y)
        # With control the drag turns the light, alone the camera; with shift or another button it
        # pans.
        modifiers = event.get("modifiers", ())
        degrees = _TURN_DEG_PER_SIDE / max(self.height_px, 1.0)
        if self._button == LEFT and ("Control" in modifiers or "l" in self._keys):
            t = self.turn
            self.turn = Turn(t.azimuth_deg + dx * degrees, t.elevation_deg - dy * degrees)
        elif self._button == LEFT and "Shift" not in modifiers:
            self._rotate(-dx * degrees, -dy * degrees)
        elif self._button in (LEFT, RIGHT, MIDDLE):
            self._pan(dx, dy)

    def _rotate(self, azimuth_deg: float, elevation_deg: float) -> None:
        # A drag keeps the point that it began about, also where walls let the eye come nearer.
        camera = self.camera
        if not self.is_flying and self._arm_m is None:
            self._begin_orbit()
            camera = self.camera
        look = np.subtract(camera.target, camera.position)
        turned = turned_direction(look, camera.up, azimuth_deg, elevation_deg)
        eye = None if self.is_flying else self._orbited(turned)
        if eye is None:  # the head turns
            self.camera = replace(camera, target=triple(np.add(camera.position, turned)))
        else:
            self.camera = replace(camera, position=triple(eye))

    def _begin_orbit(self) -> None:
        """The point that this drag orbits about, and how far the eye is from it; inf: no walls."""
        # Outdoors nothing is in the way, and the camera's own target is the pivot.
        eye, target = np.array(self.camera.position), np.array(self.camera.target)
        if self.free is None or not self.free.is_enclosed(eye):
            self._arm_m = np.inf
            return
        # Between walls the target may lie behind one; then a point before it is orbited.
        pivot = self.free.pivot(eye, target)
        self.camera = replace(self.camera, target=triple(pivot))
        self._arm_m = float(np.linalg.norm(eye - pivot))

    def _orbited(self, look: F64) -> F64 | None:
        """The eye that sees the target along `look`, as far as walls let it come there."""
        eye, target = np.array(self.camera.position), np.array(self.camera.target)
        if self.free is None or self._arm_m is None or np.isinf(self._arm_m):
            return np.asarray(target - look)
        return self.free.orbited(eye, target, -look / np.linalg.norm(look), self._arm_m)

    def _pan(self, dx: float, dy: float) -> None:
        camera = self.camera
        right, up, _ = axes(camera)
        distance = float(np.linalg.norm(np.subtract(camera.target, camera.position)))
        # A pixel is so many metres at the target's distance.
        span = 2.0 * distance * np.tan(np.radians(camera.fov_y_deg) / 2.0)
        self._shift((up * dy - right * dx) * span / max(self.height_px, 1.0))

    def _wheel(self, event: Mapping[str, Any]) -> None:
        notches = -float(event.get("dy", 0.0)) / 100.0
        camera = self.camera
        look = np.subtract(camera.target, camera.position)
        # A flying camera goes ahead by a share of the scene's reach at each notch.
        if self.is_flying:
            self._shift(look / np.linalg.norm(look) * notches * 0.02 * self.reach_m)
            return
        # An orbiting one comes nearer by a factor, so that it never passes its target; walls stop
        # it.
        least = 1e-3 * self.reach_m / float(np.linalg.norm(look))
        factor = max(_NEARER_PER_NOTCH ** float(np.clip(notches, -20, 20)), least)
        by = look * (1.0 - factor)
        eye = np.array(camera.position)
        if self.free is not None and self.free.is_enclosed(eye):
            by = self.free.moved(eye, by)
            self._arm_m = None
        self.camera = replace(camera, position=triple(eye + by))

    def _key_down(self, event: Mapping[str, Any]) -> None:
        self._keys.add(_key(event))

    def _key_up(self, event: Mapping[str, Any]) -> None:
        self._keys.discard(_key(event))

    def _shift(self, by: F64) -> None:
        self.camera = shifted(self.camera, by)


def turned_direction(v: Any, up: Vec3, azimuth_deg: float, elevation_deg: float) -> F64:
    """`v` turned about `up`, then towards it; it stays a degree away from `up` and its opposite."""
    v, axis = np.asarray(v, np.float64), np.asarray(up, np.float64)
    length = float(np.linalg.norm(v))
    height = float(v @ axis) / length
    flat = v / length - height * axis
    # Straight up or down has no azimuth: any does.
    flat = flat / np.linalg.norm(flat) if np.linalg.norm(flat) > 1e-6 else _across(axis)
    # Turned about the axis, and raised within a degree of it.
    angle = np.radians(azimuth_deg)
    flat = flat * np.cos(angle) + np.cross(axis, flat) * np.sin(angle)
    elevation = np.degrees(np.arcsin(np.clip(height, -1.0, 1.0))) + elevation_deg
    e = np.radians(np.clip(elevation, -_STEEPEST_DEG, _STEEPEST_DEG))
    return np.asarray(length * (flat * np.cos(e) + axis * np.sin(e)))


def _across(axis: F64) -> F64:
    other = np.cross(axis, (1.0, 0.0, 0.0) if abs(axis[0]) < 0.9 else (0.0, 0.0, 1.0))
    return np.asarray(other / np.linalg.norm(other))


def _key(event: Mapping[str, Any]) -> str:
    key = str(event["key"])
    return key.lower() if len(key) == 1 else key
