"""A ground for a bare model to stand on: it shows where the model is, by its shadow."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..material import Material
from ..mesh import Mesh
from ..scene import Scene
from ..shapes import quad
from ..studio import GROUND_ALBEDO, studio
from ..studio import NAME as STUDIO
from .framing import find_room, framing_box
from .probe import Probe

NAME = "ground of airlight"
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
    # What the sky shows below its horizon is a matte ground of this albedo in the same light, so
    # the square has no edge to be seen.
    sky = environment.sky
    albedo = sky.ground if sky else GROUND_ALBEDO
    material = Material(base_color=(albedo, albedo, albedo), specular=0.0)
    ground = Mesh(geometry=quad(), world_from_object=matrix, material=material, name=NAME)
    standing = replace(scene, meshes=(*scene.meshes, ground))
    if scene.meshes:
        return standing
    # Grids are framed from below, before a sky: on a ground they stand as things do.
    seen = framing_box(low, high, is_on_ground=True)
    exposed = replace(seen, exposure_stops=scene.camera.exposure_stops)
    around = environment if environment.sky else studio(scene.lights)
    return replace(standing, camera=exposed, environment=around)


def _why_none(scene: Scene, is_asked: bool) -> str | None:
    """Why no ground belongs under the scene, None where one does."""
    environment = scene.environment
    if environment is None or not (environment.horizon or environment.source == STUDIO):
        return "its light is not airlight's own"
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
    return [
        {
            "shape": "quad",
            **place,
            "base_color": ground.material.base_color[0],
            "specular": ground.material.specular,
        }
    ]


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
