"""Cameras, lights, meshes and environments that follow keyframes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import SceneError
from ...maths.transforms import rotation_xyz
from ..camera import Camera
from ..checks import F64
from .curve import Curve

if TYPE_CHECKING:
    from ..mesh import Mesh
    from ..scene import Scene

Curves = Mapping[str, Curve]


def _values(curves: Curves, time_s: float) -> dict[str, Any]:
    """{field: number or tuple} at a time."""
    values: dict[str, Any] = {}
    # Numbers for fields of one component, tuples for others.
    for name, curve in curves.items():
        value = curve.at(time_s).tolist()
        values[name] = value[0] if len(value) == 1 else tuple(value)
    return values


class _Curved:
    """What follows `curves`."""

    curves: Curves

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds."""
        return max(curve.end_s for curve in self.curves.values())


@dataclass(frozen=True, eq=False)
class CameraTrack(_Curved):
    """The scene's camera; `curves` by its fields: position, target, up, fov_y_deg ..."""

    curves: Curves

    @property
    def camera_alone(self) -> CameraTrack:
        """What it does to the camera."""
        return self

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene seen from where the camera is."""
        return replace(scene, camera=replace(scene.camera, **_values(self.curves, time_s)))


@dataclass(frozen=True, eq=False)
class OrbitTrack:
    """A camera that goes once around `pivot` in `turn_s`, its own way up; or, without a pivot,
    turns once on the spot."""

    camera: Camera
    turn_s: float
    pivot: tuple[float, float, float] | None = None

    @property
    def end_s(self) -> float:
        """When it is back, seconds."""
        return self.turn_s

    @property
    def camera_alone(self) -> OrbitTrack:
        """What it does to the camera."""
        return self

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene seen from where `camera` has gone, with that camera's lens and exposure."""
        own = self.camera
        centre = np.asarray(own.position if self.pivot is None else self.pivot, np.float64)
        up, angle = np.array(own.up), 2.0 * np.pi * time_s / self.turn_s

        # Rotated about the axis through the centre (Rodrigues): v cos a + (up x v) sin a, what
        # lies along the axis kept.
        def turned(place: tuple[float, float, float]) -> tuple[float, float, float]:
            v = np.subtract(place, centre)
            along = up * float(v @ up)
            moved = centre + along + (v - along) * np.cos(angle) + np.cross(up, v) * np.sin(angle)
            x, y, z = moved.tolist()
            return x, y, z

        camera = replace(own, position=turned(own.position), target=turned(own.target))
        return replace(scene, camera=camera)


@dataclass(frozen=True, eq=False)
class LightTrack(_Curved):
    """The scene's light number `index`; `curves` by its fields. Light stays at or above zero."""

    index: int
    curves: Curves

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene with the light as it is."""
        lights = list(scene.lights)
        _check_index(self.index, len(lights), "light")
        values = _values(self.curves, time_s)
        strength = lights[self.index].strength_name()
        if strength in values:  # smooth curves swing through below zero
            values[strength] = tuple(max(0.0, c) for c in values[strength])
        lights[self.index] = replace(lights[self.index], **values)
        return replace(scene, lights=tuple(lights))


@dataclass(frozen=True, eq=False)
class EnvironmentTrack(_Curved):
    """The scene's environment; `curves` of rotation_deg and scale."""

    curves: Curves

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene under the environment as it is."""
        if scene.environment is None:
            raise SceneError("the scene has no environment to move")
        values = _values(self.curves, time_s)
        if "scale" in values:
            values["scale"] = max(0.0, values["scale"])
        return replace(scene, environment=replace(scene.environment, **values))


@dataclass(frozen=True, eq=False)
class Placing(_Curved):
    """translate (m), rotate_deg and scale by keyframes; `still` gives those without a curve.

    `rotate_deg`: about the world's X axis, then Y, then Z. `before` (4, 4) comes before all.
    """

    curves: Curves
    still: Mapping[str, tuple[float, float, float]]
    before: F64 = field(default_factory=lambda: np.eye(4))

    def at(self, time_s: float) -> F64:
        """(4, 4) at a time."""
        # Curves take the place of the values that do not move.
        values = {**self.still, **_values(self.curves, time_s)}
        matrix = np.eye(4)
        matrix[:3, :3] = self._linear(values) if self._turns else self._still_linear
        matrix[:3, 3] = values.get("translate", (0.0, 0.0, 0.0))
        return matrix @ self.before

    @property
    def _turns(self) -> bool:
        return "scale" in self.curves or "rotate_deg" in self.curves

    @cached_property
    def _still_linear(self) -> F64:
        return self._linear(self.still)

    @staticmethod
    def _linear(values: Mapping[str, Any]) -> F64:
        scale = np.broadcast_to(np.array(values.get("scale", 1.0)), 3)
        return np.asarray(rotation_xyz(values.get("rotate_deg", (0.0, 0.0, 0.0))) * scale)


@dataclass(frozen=True, eq=False)
class MeshTrack:
    """The meshes from number `first` on, one for each of `world_from_object` (N, 4, 4).

    Those are their places before `placing` moves them.
    """

    first: int
    world_from_object: F64
    placing: Placing

    moves_meshes = True

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds."""
        return self.placing.end_s

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene with the meshes where they are."""
        meshes = list(scene.meshes)
        self.move(meshes, time_s)
        return replace(scene, meshes=tuple(meshes))

    def move(self, meshes: list[Mesh], time_s: float) -> None:
        """Put those of a scene's meshes that it moves where they are."""
        # As many meshes as the file had, from the first on.
        _check_index(self.first + len(self.world_from_object) - 1, len(meshes), "mesh")
        moved = self.placing.at(time_s) @ self.world_from_object
        for k, matrix in enumerate(moved, start=self.first):
            meshes[k] = replace(meshes[k], world_from_object=matrix)


def _check_index(index: int, count: int, what: str) -> None:
    if index >= count:
        raise SceneError(
            f"the animation moves {what} {index + 1}, but the scene has {count}",
            remedy="Keep lights and meshes in their order, or leave out the animation.",
        )
