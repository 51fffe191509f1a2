"""Matrices between spaces, named target_from_source and read as chains.

Right-handed, column vectors, clip space of WebGPU: x right, y up, depth 0..1. Cameras use
reversed infinite depth (1 near, 0 at infinity), lights conventional depth (0 near, 1 far).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arrays import F64 as F64

Vector = Sequence[float] | NDArray[Any]
_CORNERS = np.array(np.meshgrid(*[(0, 1)] * 3)).reshape(3, 8).T  # 0 the lower, 1 the upper


def unit(v: Vector) -> F64:
    """`v` / |v|."""
    a = np.asarray(v, dtype=np.float64)
    return a / np.linalg.norm(a)


def triple(v: Any) -> tuple[float, float, float]:
    """A vector or colour (3,) as Python's own numbers."""
    return (float(v[0]), float(v[1]), float(v[2]))


def smoothstep(low: float, high: float, x: F64) -> F64:
    """0 below `low`, 1 above `high`, a cubic between them."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def _cross(a: Vector, b: Vector) -> F64:
    """np.cross of two vectors, without its looking at shapes."""
    (ax, ay, az), (bx, by, bz) = a, b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], np.float64)


def view_from_world(eye: Vector, forward: Vector, up: Vector) -> F64:
    """(4, 4): the eye at the origin looking down -Z, +Y as near to `up` as it can be."""
    # The eye looks along -z; x is across `up`.
    z = -unit(forward)
    x = _cross(up, z)
    # Along `up` that says nothing: another axis takes its place.
    if np.linalg.norm(x) < 1e-9:
        x = _cross((0.0, 0.0, 1.0) if abs(z[1]) > 0.5 else (0.0, 1.0, 0.0), z)
    x = unit(x)
    y = _cross(z, x)
    m = np.eye(4)
    m[:3, :3] = (x, y, z)
    m[:3, 3] = -m[:3, :3] @ np.asarray(eye, dtype=np.float64)
    return m


def clip_from_view_infinite(fov_y: float, aspect: float, near: float) -> F64:
    """(4, 4): perspective with reversed infinite depth; `fov_y` in radians, `near` in metres."""
    f = 1.0 / np.tan(0.5 * fov_y)
    m = np.zeros((4, 4))
    m[0, 0], m[1, 1], m[2, 3], m[3, 2] = f / aspect, f, near, -1.0
    return m


def clip_from_view_perspective(fov_y: float, near: float, far: float) -> F64:
    """(4, 4): square perspective with depth 0 at `near` and 1 at `far` (metres)."""
    f = 1.0 / np.tan(0.5 * fov_y)
    m = np.zeros((4, 4))
    m[0, 0] = m[1, 1] = f
    m[2, 2], m[2, 3], m[3, 2] = far / (near - far), near * far / (near - far), -1.0
    return m


def clip_from_view_orthographic(low: Vector, high: Vector) -> F64:
    """(4, 4): the view-space box low..high to the clip box; z = high maps to depth 0."""
    # A linear map on each axis; depth falls along z.
    (x0, y0, z0), (x1, y1, z1) = low, high
    m = np.eye(4)
    m[0, 0], m[0, 3] = 2.0 / (x1 - x0), -(x1 + x0) / (x1 - x0)
    m[1, 1], m[1, 3] = 2.0 / (y1 - y0), -(y1 + y0) / (y1 - y0)
    m[2, 2], m[2, 3] = -1.0 / (z1 - z0), z1 / (z1 - z0)
    return m


def jittered(clip_from_view: F64, offset_px: Vector, size_px: tuple[int, int]) -> F64:
    """The projection with the image moved by `offset_px` (x right, y down)."""
    # Pixels to clip coordinates, whose y points up.
    shift = np.eye(4)
    shift[0, 3] = 2.0 * offset_px[0] / size_px[0]
    shift[1, 3] = -2.0 * offset_px[1] / size_px[1]
    return np.asarray(shift @ clip_from_view)


def box_corners(low: Vector, high: Vector) -> F64:
    """(8, 3): the corners of an axis-aligned box."""
    return np.array((low, high), dtype=np.float64)[_CORNERS, (0, 1, 2)]


def placed_points(points: NDArray[Any], matrix: NDArray[np.floating[Any]]) -> F64:
    """(..., 3) points through an affine 4x4 matrix."""
    return np.asarray(points @ matrix[:3, :3].T + matrix[:3, 3])


def transformed(points: F64, matrix: F64) -> F64:
    """(n, 3) points through a 4x4 matrix, with the perspective division."""
    w = points @ matrix[3, :3] + matrix[3, 3]
    return np.asarray(placed_points(points, matrix) / w[..., None])


def cofactors(linear: F64) -> F64:
    """(..., 3, 3): det * inverse transpose of matrices, which turns areas' normals as `linear`
    turns the areas; it exists for those without volume, too."""
    a, b, c = np.moveaxis(linear, -1, 0)
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)


def normal_matrix(world_from_object: F64) -> F64:
    """(..., 4, 4): for normals of surfaces, as long as the placement stretches their area."""
    linear = world_from_object[..., :3, :3]
    normal = np.broadcast_to(np.eye(4), world_from_object.shape).copy()
    sign = np.where(np.linalg.det(linear) < 0.0, -1.0, 1.0)
    normal[..., :3, :3] = cofactors(linear) * sign[..., None, None]
    return normal


def rotation_xyz(angles_deg: Vector) -> F64:
    """(3, 3): about the world's X axis first, then Y, then Z; counter-clockwise seen against it."""
    # Each axis' own turn, joined from the right.
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians(angles_deg)), np.sin(np.radians(angles_deg))
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(about_z @ about_y @ about_x)


def trs_matrix(translation: Vector, rotation: Vector, scale: Vector) -> F64:
    """(4, 4): scale, then rotate by the unit quaternion (x, y, z, w), then translate.

    Of K of each, (K, 3), (K, 4) and (K, 3), they are (K, 4, 4).
    """
    x, y, z, w = np.asarray(rotation).T
    # The rotation of a unit quaternion (Shoemake1985); its columns are scaled.
    turned = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    # Of several the numbers of each stand last, and belong first.
    turned = turned.transpose(2, 0, 1) if turned.ndim == 3 else turned
    matrix = np.zeros((*turned.shape[:-2], 4, 4))
    matrix[..., :3, :3] = turned * np.asarray(scale)[..., None, :]
    matrix[..., :3, 3] = translation
    matrix[..., 3, 3] = 1.0
    return matrix


def box_around(boxes: Sequence[Sequence[Any]]) -> tuple[F64, F64]:
    """Lower and upper corner of the box around `boxes`, which are pairs of corners."""
    return np.min([box[0] for box in boxes], axis=0), np.max([box[1] for box in boxes], axis=0)


def box_along(axes: F64, low: Vector, high: Vector) -> tuple[F64, F64]:
    """The box along `axes` (3, 3), unit vectors in rows, around the box low..high; metres.

    The transpose of the axes leads back to the world.
    """
    # Corners of the box, in coordinates along the axes.
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    corners = (low + _CORNERS * (high - low)) @ axes.T
    return corners.min(axis=0), corners.max(axis=0)
