"""Scenes moved to an origin near their camera, where single precision tells millimetres apart.

Three kilometres from the origin of the world neighbouring float32 numbers are .24 mm apart, and
what is computed from a few of them is off by centimetres. Devices are given positions from an
origin of their own; the host subtracts it, in double precision.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from .animation import Animation
from .camera import Camera
from .checks import F64, Vec3
from .medium import Medium
from .mesh import Mesh
from .placing import moved_camera, moved_point
from .point_lights import PointLights
from .scene import Scene
from .volume import Volume

_STEPS = 16.0
_MOST_STEPS = 2.0**20  # a multiple of a power of two that single precision still has exactly


def origin_near(scene: Scene) -> Vec3:
    """An origin, metres, from which what the scene's camera sees is not far, or the world's own.

    It is a multiple of a power of two, 16 to 32 times how far the camera looks. Scenes that lie
    around the origin of the world, as far as can be told from what is seen of them, keep it.
    """
    camera = scene.camera
    eye = np.array(camera.position)
    low, high = scene.bounds
    # A camera of a file may look at a point before its lens; what it sees may begin far from it.
    before = float(np.linalg.norm(np.maximum(np.maximum(low - eye, eye - high), 0.0)))
    sight = max(before, float(np.linalg.norm(np.subtract(camera.target, eye))))
    sight = max(sight, float(np.abs(eye).max()) / _MOST_STEPS)
    # Whole steps of a power of two, so that single precision holds the origin exactly.
    step = _STEPS * 2.0 ** np.ceil(np.log2(sight))
    x, y, z = (step * np.round(eye / step) + 0.0).tolist()  # no negative zeros
    return (x, y, z)


class Nearby:
    """Moves scenes so that `origin`, metres in the world, becomes their own origin.

    What has not changed since the scene before stays the same object, as caches want it.
    """

    def __init__(self, origin: Vec3) -> None:
        self.origin = origin
        self._by = np.eye(4)
        self._by[:3, 3] = np.negative(origin)
        self._is_needed = any(origin)
        self._last: dict[str, tuple[Any, Any]] = {}
        self._meshes: dict[int, tuple[Mesh, Mesh]] = {}

    def of(self, scene: Scene) -> Scene:
        """The scene from `origin`; the very same where that is the world's."""
        if not self._is_needed:
            return scene
        # What has a place in the world, and how it moves.
        ways: dict[str, Callable[[Any], Any]] = {
            "meshes": self._moved_meshes,
            "lights": lambda all_: tuple(light.moved(self._by) for light in all_),
            "camera": self.camera,
            "medium": self._moved_medium,
            "volumes": lambda all_: tuple(self._moved_volume(v) for v in all_),
            "light_groups": lambda all_: tuple(self._moved_group(g) for g in all_),
            "animation": self._moved_animation,
        }
        return replace(scene, **{n: self._once(n, getattr(scene, n), by) for n, by in ways.items()})

    def camera(self, camera: Camera) -> Camera:
        """A camera from `origin`."""
        return moved_camera(camera, self._by) if self._is_needed else camera

    def box(self, bounds: Sequence[float]) -> tuple[float, ...]:
        """A box x0,y0,z0,x1,y1,z1 from `origin`; what is no box stays as it is."""
        if len(bounds) != 6 or not self._is_needed:
            return tuple(bounds)
        return tuple((np.reshape(bounds, (2, 3)) - self.origin).ravel().tolist())

    def _once(self, name: str, given: Any, moved: Callable[[Any], Any]) -> Any:
        known = self._last.get(name)
        if known is None or known[0] is not given:
            known = self._last[name] = (given, moved(given))
        return known[1]

    def _moved_meshes(self, meshes: Sequence[Mesh]) -> tuple[Mesh, ...]:
        # Meshes by identity: those that were there before keep their moved ones.
        known = self._meshes
        self._meshes = {
            id(mesh): known[id(mesh)] if id(mesh) in known else (mesh, self._moved_mesh(mesh))
            for mesh in meshes
        }
        return tuple(self._meshes[id(mesh)][1] for mesh in meshes)

    def _moved_mesh(self, mesh: Mesh) -> Mesh:
        return replace(mesh, world_from_object=self._by @ mesh.world_from_object)

    def _moved_medium(self, medium: Medium | None) -> Medium | None:
        if medium is None:
            return None
        bounds, top = medium.bounds, medium.top
        if bounds is not None:
            bounds = (moved_point(bounds[0], self._by), moved_point(bounds[1], self._by))
        return replace(medium, bounds=bounds, top=None if top is None else top - self.origin[1])

    def _moved_volume(self, volume: Volume) -> Volume:
        return replace(volume, world_from_volume=self._by @ volume.world_from_volume)

    def _moved_group(self, group: PointLights) -> PointLights:
        moved = group.positions.astype(np.float64) - self.origin
        return replace(group, positions=moved.astype(np.float32))

    def _moved_animation(self, animation: Animation | None) -> Animation | None:
        if animation is None:
            return None
        # An animation's tracks stay in the world; it moves scenes there and back.
        same = {f.name: getattr(animation, f.name) for f in fields(Animation)}
        return _NearbyAnimation(**same, origin=self.origin)


@dataclass(frozen=True, eq=False)
class _NearbyAnimation(Animation):
    """An animation whose tracks have places of the world, of scenes from `origin`."""

    origin: Vec3 = (0.0, 0.0, 0.0)

    def at(self, scene: Scene, time_s: float) -> Scene:
        """As `Animation.at`, from `origin`."""
        moment = Nearby(self.origin).of(super().at(self._in_world(scene), time_s))
        return replace(moment, animation=self)

    def moments(self, scene: Scene) -> Iterator[Scene]:
        """As `Animation.moments`, from `origin`."""
        nearby = Nearby(self.origin)
        yield from map(nearby.of, super().moments(self._in_world(scene)))

    def eyes(self, scene: Scene) -> list[Vec3]:
        """As `Animation.eyes`, from `origin`."""
        by: F64 = np.eye(4)
        by[:3, 3] = np.negative(self.origin)
        return [moved_point(eye, by) for eye in super().eyes(self._in_world(scene))]

    def _in_world(self, scene: Scene) -> Scene:
        x, y, z = self.origin
        return Nearby((-x, -y, -z)).of(replace(scene, animation=None))
