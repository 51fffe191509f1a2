"""A ground for a bare model to stand on: it shows where the model is, by its shadow."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from ..checks import F32, F64
from ..environment import Environment
from ..lights import DirectionalLight
from ..material import Material
from ..mesh import Mesh
from ..scene import Scene
from ..shapes import quad
from .framing import find_room, framing_box
from .probe import Probe

NAME = "ground of airlight"
ALBEDO = 0.3
REACH = 6.0
"""Half the side of the ground, over the larger of the model's half width and height."""
NONE = "no ground was put under it: {why}"
"""A warning where one was asked for."""
_PLACES = 9  # along each side of the box around the model
_FLOOR_SHARE = 0.5
_SUNK = 1e-4  # of the model's size: its own lowest faces stay in front


def with_ground(scene: Scene, *, is_asked: bool = False) -> Scene:
    """The scene on a matte square under its lowest point, in the colour of its sky's ground.

    Without one where it is a room, has a floor or light of its own, or no meshes. `is_asked`: one
    is put under grids, too, and a warning says why there is none.
    """
    environment, why = scene.environment, _why_none(scene, is_asked)
    if environment is None or why is not None:
        said = (NONE.format(why=why),) if is_asked else ()
        return replace(scene, warnings=(*scene.warnings, *said)) if said else scene
    # Wide enough for long shadows, a little below the lowest point so that nothing flickers in it.
    low, high = scene.whole_bounds
    half = REACH * float(max((high - low)[[0, 2]].max() / 2.0, (high - low)[1]))
    at = (low + high) / 2.0
    at[1] = low[1] - _SUNK * float(np.linalg.norm(high - low))
    matrix = np.diag((2.0 * half, 1.0, 2.0 * half, 1.0))
    matrix[:3, 3] = at
    # A computed sky says how bright its ground is; a map's ground gets the usual albedo.
    sky = environment.sky
    albedo = sky.ground if sky else ALBEDO
    material = Material(base_color=(albedo, albedo, albedo), roughness=1.0)
    ground = Mesh(geometry=quad(), world_from_object=matrix, material=material, name=NAME)
    standing = replace(scene, meshes=(*scene.meshes, ground), environment=_matched(scene))
    if scene.meshes:
        return standing
    # Grids, which have no camera of their own, are framed from below: there the ground hides them.
    seen = framing_box(low, high, is_on_ground=True)
    exposed = replace(seen, exposure_stops=scene.camera.exposure_stops)
    return replace(standing, camera=exposed)


def _why_none(scene: Scene, is_asked: bool) -> str | None:
    """Why no ground belongs under the scene, None where one does."""
    if scene.environment is None or not scene.environment.horizon:
        return "its light is not airlight's daylight"
    # Grids alone are no room and have no floor; they get a ground where one is asked for.
    probe = Probe.of(scene)
    if len(probe.corners) == 0:
        return None if is_asked and scene.volumes else "it has no meshes"
    if find_room(probe) is not None:
        return "it is a room"
    return "it has a floor" if _has_floor(probe) else None


def without_ground(scene: Scene) -> Scene:
    """The scene less what `with_ground` put under it: what has a size of its own."""
    return replace(scene, meshes=scene.meshes[:-1]) if ground_tables(scene) else scene


def ground_tables(scene: Scene) -> list[dict[str, Any]]:
    """The [[mesh]] of a ground that `with_ground` added last; empty where it added none."""
    if not scene.meshes or scene.meshes[-1].name != NAME:
        return []
    ground = scene.meshes[-1]
    matrix = ground.world_from_object
    place = {"translate": matrix[:3, 3], "scale": np.diag(matrix)[:3]}
    # As `with_ground` made it: a matrix of a scale and a shift.
    return [{"shape": "quad", **place, "base_color": ground.material.base_color[0]}]


def _has_floor(probe: Probe) -> bool:
    """Whether most rays down onto the model's box end at something near its lowest point."""
    points = probe.corners.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    # Rays straight down, on a grid over the model.
    steps = np.linspace(-0.49, 0.49, _PLACES)
    x, z = (a.ravel() for a in np.meshgrid(steps, steps))
    middle, size = (low + high) / 2.0, high - low
    origins = np.stack([middle[0] + x * size[0], np.full(x.shape, high[1] + size[1] + 1e-3),
                        middle[2] + z * size[2]], axis=1)  # fmt: skip
    distance = probe.cast(origins, np.tile((0.0, -1.0, 0.0), (len(x), 1))).distance
    # What most of them meet near the lowest point is a floor; a flat model is one itself.
    height = origins[:, 1] - distance
    near = np.isfinite(distance) & (height < low[1] + 0.05 * float(size[1]))
    is_flat = float(size[1]) < 0.02 * float(max(size[0], size[2]))
    return bool(is_flat or near.mean() > _FLOOR_SHARE)


def _matched(scene: Scene) -> Environment | None:
    """The environment with the ground below its horizon lit as the square is.

    So the square has no edge to be seen.
    """
    environment = scene.environment
    if environment is None or environment.map is None or environment.sky is not None:
        return environment  # a computed sky's ground is lit already
    # What the ground receives from the sky and from the directional lights above it.
    received = _received(environment.map)
    for light in scene.lights:
        if isinstance(light, DirectionalLight):
            received += np.array(light.irradiance) * max(-light.direction[1], 0.0)
    below = environment.map.copy()
    # A matte ground sends albedo / pi times that everywhere.
    below[(len(below) + 1) // 2 :] = ALBEDO / np.pi * received
    return replace(environment, map=below)


def _received(radiance: F32) -> F64:
    """Irradiance (3,) of the ground under the upper half of a map."""
    height, width = radiance.shape[:2]
    up = latlong_texel_directions(height, width)[: height // 2, :, 1]
    weights = up * latlong_row_solid_angles(height, width)[: height // 2, None]
    return np.asarray((radiance[: height // 2] * weights[..., None]).sum(axis=(0, 1)), np.float64)
