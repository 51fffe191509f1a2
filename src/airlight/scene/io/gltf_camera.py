"""A glTF camera as airlight's, or the reason why it is none."""

from __future__ import annotations

import math

import numpy as np

from ...maths.transforms import triple
from ..camera import Camera, film_of
from ..checks import F64
from .gltf_json import Item


def placed_camera(item: Item, matrix: F64, doubts: list[str]) -> Camera | None:
    """The camera at a node that `matrix` (4, 4) places; None where it sees nothing.

    What it does not get goes to `doubts`. Raises SceneError for values that are no numbers.
    """
    if item.text("type") != "perspective":
        doubts.append("only perspective cameras are used")
        return None
    # One that sees nothing is no camera; a strange shape of its image is its own loss.
    lens = item.child("perspective")
    fov_y, aspect = lens.number("yfov", 0.0), lens.number("aspectRatio", 0.0)
    if not 0.0 < fov_y < math.pi:
        doubts.append(f"its yfov {fov_y:g} is no field of view: it is left out")
        return None
    if lens.has("aspectRatio") and film_of(aspect) is None:
        doubts.append(f"its aspectRatio {aspect:g} is left out")
    # It looks along its node's -Z.
    position, forward = matrix[:3, 3], -matrix[:3, 2]
    return Camera(
        position=triple(position),
        target=triple(position + forward / max(float(np.linalg.norm(forward)), 1e-30)),
        up=triple(matrix[:3, 1]),
        fov_y_deg=float(np.clip(math.degrees(fov_y), 0.1, 179.0)),
        film_px=film_of(aspect),
    )
