"""Light that no path leads from to the eye: what closed opaque walls part from it.

A light in a cupboard, the sun outside a room without windows: lattices and shadow maps would let
some of it through walls that are thinner than their cells and texels. Which side of a closed
surface a point is on is known exactly, so such light is left out, in every layer.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..lattice.rooms import Rooms
from ..maths.transforms import F64
from ..scene.environment import Environment
from ..scene.lights import DirectionalLight, Light
from ..scene.mesh import Mesh
from ..scene.scene import Scene


class Hidden:
    """What `rooms`, of the meshes of all frames, hide of a scene's lights and sky."""

    def __init__(self, rooms: Rooms) -> None:
        self._rooms = rooms
        # What was asked last with its answer, and the last sky with the dark one in its place.
        self._asked: tuple[Scene, tuple[Mesh, ...], Scene] | None = None
        self._sky: tuple[Environment, Environment] | None = None

    def without(self, scene: Scene, meshes: tuple[Mesh, ...]) -> Scene:
        """The scene whose hidden lights, and sky, give nothing; the same where none is hidden.

        `meshes`: as they are. Lights with extent are samples already, each on a side of its own.
        """
        last = self._asked
        if last is None or not (meshes is last[1] and _looks_alike(scene, last[0])):
            self._asked = last = scene, meshes, self._found(scene, meshes)
        seen = last[2]
        if seen.lights is scene.lights and seen.environment is scene.environment:
            return scene
        return replace(scene, lights=seen.lights, environment=seen.environment)

    def _found(self, scene: Scene, meshes: tuple[Mesh, ...]) -> Scene:
        # The eye, the lights, and far away all light that has no place.
        camera = scene.camera
        places = [_position(light) for light in scene.lights]
        points = np.array([*places, (np.inf,) * 3])
        extents = [getattr(light, "extent", 0.0) for light in scene.lights]
        reaches = np.array([0.5 * camera.aperture_m, *extents, 0.0])
        eye = np.array(camera.position, np.float64)
        is_hidden = self._rooms.parted(meshes, eye, points, reaches)
        if not is_hidden.any():
            return scene

        # As many lights as before, since the device has a place for each.
        pairs = zip(scene.lights, is_hidden, strict=False)
        lights: tuple[Light, ...] = tuple(x.darkened() if hidden else x for x, hidden in pairs)
        sky = self._dark(scene.environment) if is_hidden[-1] else scene.environment
        return replace(scene, lights=lights, environment=sky)

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
    place = (np.inf,) * 3 if isinstance(light, DirectionalLight) else light.position
    return np.array(place, np.float64)
