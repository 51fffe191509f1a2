"""Points, directions and cameras moved by a matrix."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..maths.transforms import triple
from .camera import Camera
from .checks import F64, Vec3


def moved_camera(camera: Camera, matrix: F64) -> Camera:
    """The camera through a (4, 4) matrix; its field of view stays."""
    return replace(
        camera,
        position=moved_point(camera.position, matrix),
        target=moved_point(camera.target, matrix),
        up=moved_vector(camera.up, matrix),
    )


def camera_at(camera: Camera, position: Vec3) -> Camera:
    """The camera at another `position`, metres, with the direction in which it looks."""
    return shifted(camera, np.subtract(position, camera.position))


def shifted(camera: Camera, by: F64) -> Camera:
    """The camera elsewhere, by (3,) metres, looking the same way."""
    return replace(
        camera,
        position=triple(np.add(camera.position, by)),
        target=triple(np.add(camera.target, by)),
    )


def moved_point(p: Vec3, matrix: F64) -> Vec3:
    """A point through a (4, 4) matrix."""
    x, y, z = matrix[:3, :3] @ np.asarray(p) + matrix[:3, 3]
    return (float(x), float(y), float(z))


def moved_vector(v: Vec3, matrix: F64) -> Vec3:
    """A direction through a (4, 4) matrix, of whatever length."""
    x, y, z = matrix[:3, :3] @ np.asarray(v)
    return (float(x), float(y), float(z))
