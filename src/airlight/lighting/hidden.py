"""Light that no path leads from to the eye: what closed opaque walls part from it.

A light in a cupboard, the sun outside a room without windows: lattices and shadow maps would let
some of it through walls that are thinner than their cells and texels. Which side of a closed
surface a point is on is known exactly, so such light is left out, in every layer. Lights with
extent stay: what stands for parts of them may have parts on both sides of a wall.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..area.sources import has_extent
from ..lattice.rooms import Rooms
from ..maths.transforms import F64
from ..scene.environment import Environment
from ..scene.fingerprint import is_same
from ..scene.lights import Light
from ..scene.mesh import Mesh
from ..scene.scene import Scene


class Hidden:
    """What `rooms`, of the meshes of all frames, hide of a scene's lights and sky."""

    def __init__(self, rooms: Rooms) -> None:
        self._rooms = rooms
        # What was asked last with its answer, and the last sky with the dark one in its place.
        self._asked: tuple[Scene, tuple[Mesh, ...], tuple[bool, ...]] | None = None
        self._sky: tuple[Environment, Environment] | None = None
        # Lights with their dark ones, and the lights of a scene: the same objects in each frame.
        self._darkened: list[tuple[Light, Light]] = []
        self._lights: tuple[Light, ...] = ()

    def flags(self, scene: Scene, meshes: tuple[Mesh, ...]) -> tuple[bool, ...]:
        """Of each light whether it is hidden, last whether the sky is; `meshes` as they are."""
        last = self._asked
        if last is None or not (meshes is last[1] and _looks_alike(scene, last[0])):
            self._asked = last = scene, meshes, self._found(scene, meshes)
        return last[2]

    def without(self, scene: Scene, meshes: tuple[Mesh, ...]) -> Scene:
        """The scene whose hidden lights, and sky, give nothing; the same where none is hidden."""
        flags = self.flags(scene, meshes)
        if not any(flags):
            return scene

        # As many lights as before, since the device has a place for each.
        pairs = zip(scene.lights, flags, strict=False)
        lights = tuple(self._dark_light(x) if hidden else x for x, hidden in pairs)
        self._darkened = [pair for pair in self._darkened if any(pair[1] is x for x in lights)]
        if not is_same(lights, self._lights):
            self._lights = lights
        sky = self._dark(scene.environment) if flags[-1] else scene.environment
        return replace(scene, lights=self._lights, environment=sky)

    def _found(self, scene: Scene, meshes: tuple[Mesh, ...]) -> tuple[bool, ...]:
        # The eye, the lights, and far away all light that has no place.
        camera = scene.camera
        points = np.array([*map(_position, scene.lights), (np.inf,) * 3])
        reaches = [np.inf if _has_parts(light) else 0.0 for light in scene.lights]
        eye = np.array(camera.position, np.float64)
        clear_m = np.array([0.5 * camera.aperture_m, *reaches, 0.0])
        return tuple(self._rooms.parted(meshes, eye, points, clear_m).tolist())

    def _dark_light(self, light: Light) -> Light:
        """One that gives nothing, the same one for the same light."""
        found = next((dark for known, dark in self._darkened if known is light), None)
        if found is None:
            found = light.darkened()
            self._darkened.append((light, found))
        return found

    def _dark(self, sky: Environment | None) -> Environment | None:
        """A sky that gives nothing, the same one for the same sky, so that it is lit once."""
        if sky is None:
            return None
        if self._sky is None or self._sky[0] is not sky:
            self._sky = sky, replace(sky, scale=0.0)
        return self._sky[1]


def _looks_alike(scene: Scene, other: Scene) -> bool:
    """Whether eye, lights and sky are the same in both."""
    a, b = scene.camera, other.camera
    same_eye = a.position == b.position and a.aperture_m == b.aperture_m
    return same_eye and scene.lights is other.lights and scene.environment is other.environment


def _position(light: Light) -> F64:
    """Where it is, metres: a distant light is outside of everything."""
    return np.array(getattr(light, "position", (np.inf,) * 3), np.float64)


def _has_parts(light: Light) -> bool:
    """Whether it has extent, or stands for a part of a light that has."""
    return light.has_size or has_extent(light)
