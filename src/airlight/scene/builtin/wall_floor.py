"""A lit wall over a floor: form factors that quadrature knows."""

from __future__ import annotations

import numpy as np

from ..camera import Camera
from ..checks import number
from ..lights import DirectionalLight
from ..scene import Scene
from .patch import lambert
from .solids import rectangle

ALBEDO = 0.8


def wall_floor(*, cells: int = 12, cell_m: float = 0.25) -> Scene:
    """A Lambert wall of `cells` x `cells` cells at z = 0 facing +z, a floor as large before it.

    Light travels along -z: the wall is uniformly bright with radiosity ALBEDO * pi
    W m^-2 (radiance ALBEDO), and the floor receives none but the wall's. Both are square,
    centred on x = 0, the floor at y = 0 for z from 0 to `cells` * `cell_m`.
    Raises SceneError for sizes that are not positive.
    """
    side = number(cells, "cells", low=1) * number(cell_m, "cell_m", low=1e-6)
    # Pure Lambert, as form factors assume.
    grey = lambert("grey", (ALBEDO,) * 3)
    wall = rectangle((-side / 2, side, 0.0), (side, 0.0, 0.0), (0.0, -side, 0.0))
    floor = rectangle((-side / 2, 0.0, 0.0), (side, 0.0, 0.0), (0.0, 0.0, side))
    return Scene(
        name="wall-floor",
        meshes=(
            *grey.meshes(wall, "wall"),
            *grey.meshes(floor, "floor"),
        ),
        lights=(DirectionalLight((0.0, 0.0, -1.0), (np.pi, np.pi, np.pi)),),
        camera=Camera((0.0, 0.9 * side, 2.6 * side), (0.0, 0.3 * side, 0.3 * side), fov_y_deg=40),
    )
