"""Sensors of Mitsuba 3's scenes as cameras."""

from __future__ import annotations

import math

import numpy as np

from ...errors import SceneError
from ..camera import Camera
from ..checks import MOST_PX, Vec3
from .mitsuba_nodes import Node
from .mitsuba_textures import Source

DEFAULT_FILM = (768, 576)
"""Pixels of an image where no size is asked for, as `airlight.render` has it."""
DEFAULT_FOCAL_MM, FILM_DIAGONAL_MM = 50.0, math.hypot(36.0, 24.0)


def camera_of(node: Node, source: Source) -> Camera:
    """The camera that a sensor is; what of it cannot be is noted. Raises SceneError."""
    if node.kind not in ("perspective", "thinlens"):
        source.note(f"{node} is read as a perspective one")
    # The lens: only a thin one is out of focus anywhere, though others may say where they focus.
    aperture_m, focus_m = 0.0, None
    focus_distance_m = float(node.get("focus_distance", 1.0))
    if node.kind == "thinlens":
        aperture_m, focus_m = 2.0 * float(node.get("aperture_radius", 0.0)), focus_distance_m
    # The placement: Mitsuba's cameras look along +Z.
    matrix = node.get("to_world")
    matrix = np.eye(4) if matrix is None else np.asarray(matrix, dtype=np.float64)
    forward = matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    x, y, z = (float(v) for v in matrix[:3, 3])
    target = matrix[:3, 3] + forward
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        source.note(f"{node}: its transform mirrors the image, which is left out")
    up: Vec3 = tuple(float(v) for v in matrix[:3, 1])  # type: ignore[assignment]
    film = _film(node)
    return Camera(
        position=(x, y, z),
        target=(float(target[0]), float(target[1]), float(target[2])),
        up=up,
        fov_y_deg=_fov_y(node, film),
        film_px=film,
        aperture_m=aperture_m,
        focus_m=focus_m,
    )


def _film(node: Node) -> tuple[int, int]:
    """Width and height of the camera's images, pixels."""
    film = node.first("film")
    # A side that the film does not say has its usual length.
    if film is None:
        return DEFAULT_FILM
    width, height = (
        int(film.get(side, usual))
        for side, usual in zip(("width", "height"), DEFAULT_FILM, strict=True)
    )
    if not all(1 <= side <= MOST_PX for side in (width, height)):
        raise SceneError(f"{film} has the impossible size {width} x {height}")
    return width, height


def _fov_y(node: Node, film: tuple[int, int]) -> float:
    """The vertical field of view, degrees, of images of such a size, from whichever axis is
    given."""
    aspect = film[0] / film[1]
    # Half the angle's tangent along the axis that the file says.
    fov, axis = node.get("fov"), str(node.get("fov_axis", "x")).lower()
    if fov is None:
        focal = float(str(node.get("focal_length", f"{DEFAULT_FOCAL_MM}mm")).removesuffix("mm"))
        tan, axis = FILM_DIAGONAL_MM / (2.0 * focal), "diagonal"
    else:
        tan = math.tan(math.radians(float(fov)) / 2.0)
    # The same along the vertical axis.
    # The smaller side is the vertical one of a wide image; so is the larger of a tall one.
    if axis in ("smaller", "larger"):
        axis = "y" if (aspect > 1.0) == (axis == "smaller") else "x"
    # The tangent goes with the length along the axis: aspect : 1 : their hypotenuse.
    if axis == "x":
        tan /= aspect
    elif axis == "diagonal":
        tan /= math.hypot(1.0, aspect)
    elif axis != "y":
        raise SceneError(f"{node}: fov_axis '{axis}' is unknown", remedy="Use x or y.")
    return 2.0 * math.degrees(math.atan(tan))
