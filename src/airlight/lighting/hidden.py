"""Light that no path leads from to the eye: what closed opaque walls part from it.

A lamp in a cupboard, the sun outside a room without windows: lattices and shadow maps would let
some of it through walls that are thinner than their cells and texels. Which side of a closed surface
a point is on is known exactly, so such light is left out, in every layer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..lattice.rooms import Rooms
from ..maths.transforms import F64
from ..scene.lights import DirectionalLight, Light
from ..scene.mesh import Mesh
from ..scene.scene import Scene


def without_hidden(scene: Scene, rooms: Rooms, meshes: Sequence[Mesh]) -> Scene:
    """The scene whose hidden lights, and sky, give nothing; the same one where there are none.

    `rooms`: of the `meshes`. Lights with extent are samples already, each with its own side.
    """
    # The eye, the lights, and far away all light that has no place.
    camera = scene.camera
    places = [_position(light) for light in scene.lights]
    points = np.array([*places, (np.inf,) * 3])
    extents = [getattr(light, "extent", 0.0) for light in scene.lights]
    reaches = np.array([0.5 * camera.aperture_m, *extents, 0.0])
    is_hidden = rooms.parted(meshes, np.array(camera.position, np.float64), points, reaches)
    if not is_hidden.any():
        return scene

    # As many lights as before, since the device has a place for each.
    pairs = zip(scene.lights, is_hidden, strict=False)
    lights: tuple[Light, ...] = tuple(x.darkened() if hidden else x for x, hidden in pairs)
    sky = scene.environment
    if sky is not None and is_hidden[-1]:
        sky = replace(sky, scale=0.0)
    return replace(scene, lights=lights, environment=sky)


def _position(light: Light) -> F64:
    """Where it is, metres: a distant light is outside of everything."""
    place = (np.inf,) * 3 if isinstance(light, DirectionalLight) else light.position
    return np.array(place, np.float64)
