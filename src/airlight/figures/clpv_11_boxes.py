"""Three boxes in a row: does the hidden one cast a shadow (Kaplanyan2010 Fig. 11, right)?"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..app.compare.images import shown
from ..maths.colour import luminance
from ..scene.builtin.patch import lambert
from ..scene.builtin.solids import box
from ..scene.camera import Camera
from ..scene.checks import F32
from ..scene.lights import SpotLight
from ..scene.scene import Scene
from .cascades import surface_points
from .panels import Request, exposure_of, rendered
from .truths import averaged, smoothed, told_of, truth_of

# One lattice with the last box and without it, whatever faces it has.
_ALL: Mapping[str, Any] = {"bounces": False, "follow_walls": False}
_SEEN: Mapping[str, Any] = {**_ALL, "surfel_source": "views"}
MODES: Mapping[str, Mapping[str, Any]] = {
    "paper's scheme, seen once": {**_SEEN, "scheme": "paper", "peel_layers": 1},
    "paper's scheme, peeled": {**_SEEN, "scheme": "paper", "peel_layers": 8},
    "our scheme, seen once": {**_SEEN, "peel_layers": 1},
    "ours": _ALL,
}
"""The first two as the paper has it; the last two differ in where blockers come from alone."""
BOXES_Z_M = (1.6, -0.2, -2.2)
"""Middles of the boxes, the nearest first."""
_HALF_M, _HIGH_M = (0.4, 0.65), 2.2
SHADOW_M = ((0.45, -2.6), (1.25, -1.8))
"""Corners (x, z) of the floor that the last box hides from the lit wall."""


def boxes_row(request: Request, told: dict[str, Any]) -> tuple[str, list[Any]]:
    """One bounce around the boxes, and how much of it the last of them leaves behind itself."""
    # With the hidden box and without it: the difference is its shadow.
    scene, less = three_boxes(), three_boxes(2)
    truth, without = truth_of(request, scene), truth_of(request, less)
    where = floor_behind(scene.camera, request.size)
    cells: list[Any] = []
    stops = None
    for label, settings in MODES.items():
        image, open_ = (rendered(request, s, settings) for s in (scene, less))
        if stops is None or label == "our scheme, seen once":
            # The paper's scheme carries little across a floor: its shapes are shown, then ours.
            stops = exposure_of(scene, image.layers["indirect"])
        left = _left(image.layers["indirect"], open_.layers["indirect"], where)
        told[label] = {"light_left_in_the_last_shadow": left}
        cells.append((f"{label}: {left:.0%} left", shown(image.layers["indirect"], stops)))

    # The path tracer's shadow on the same part of the floor.
    if truth is not None and without is not None:
        light, other = (t.image.layers["one_bounce"] for t in (truth, without))
        where = averaged(where.astype(np.float32), light) > 0.5
        left = _left(light, other, where)
        told["path traced"] = {"light_left_in_the_last_shadow": left, "spp": truth.spp}
        smooth = smoothed(light, image)
        cells.append((f"{told_of(truth)}: {left:.0%} left", shown(smooth, stops or 0.0)))
    return "hidden box", cells


def _left(light: F32, without: F32, where: NDArray[np.bool_]) -> float:
    """Light of those pixels over what they have without the last box."""
    with_box, none = (float(luminance(pixels)[where].sum()) for pixels in (light, without))
    return with_box / max(none, 1e-30)


def floor_behind(camera: Camera, size: tuple[int, int]) -> NDArray[np.bool_]:
    """(H, W): pixels whose rays meet the floor within SHADOW_M; no box is before that."""
    width, height = size

    # Rays of all pixels, to where they meet the floor.
    eye = np.array(camera.position)
    rays = surface_points(camera, np.ones((height, width), np.float32)) - eye
    t = -eye[1] / np.minimum(rays[..., 1], -1e-9)
    x, z = (eye[axis] + t * rays[..., axis] for axis in (0, 2))

    # Of those points the ones behind the last box.
    low, high = SHADOW_M
    is_within = (x > low[0]) & (x < high[0]) & (z > low[1]) & (z < high[1])
    return np.asarray((rays[..., 1] < 0.0) & is_within)


def three_boxes(count: int = len(BOXES_Z_M)) -> Scene:
    """A floor, a wall to the left that a lamp lights, and the first `count` boxes in a row.

    The eye stands before the row: the first box hides the others, but not their shadows.
    """
    # White solids: the floor, the lit wall, and boxes on the floor.
    white = lambert("white", (0.7,) * 3)
    (x, z), y = _HALF_M, _HIGH_M
    solids = [box((-4.2, -0.2, -4.0), (4.0, 0.0, 4.0)), box((-4.2, 0.0, -4.0), (-4.0, 3.0, 4.0))]
    solids += [box((-x, 0.0, at - z), (x, y, at + z)) for at in BOXES_Z_M[:count]]
    meshes = tuple(mesh for solid in solids for mesh in white.meshes(solid, "box"))

    # The spot lights the wall alone; the boxes see its reflection.
    spot = SpotLight((-2.2, 1.4, -2.2), (-1.0, -0.45, 0.0), (60.0,) * 3, 15.0, 22.0)
    camera = Camera((0.0, 1.9, 5.5), (0.5, 0.4, -0.4), fov_y_deg=42.0, exposure_stops=None)
    return Scene(name="three-boxes", meshes=meshes, lights=(spot,), camera=camera)
