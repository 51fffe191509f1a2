"""Moulded profiles, and the surfaces they sweep: around an axis, a rectangle, an arch, a line.

A profile is walked so that its outside lies on the right hand: upwards for a column.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..checks import F64
from ..mesh import Geometry
from .patch import merged, patch

Points = list[tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Profile:
    """A polyline whose sharp corners are doubled, each copy with its own normal.

    `points`, `normals` (M, 2); `lengths` (M,) metres walked; `segments` (K, 2) indices.
    """

    points: F64
    normals: F64
    lengths: F64
    segments: NDArray[np.intp]


def profile(points: Points, crease_deg: float = 35.0) -> Profile:
    """The profile through `points` (metres); turns sharper than `crease_deg` are edges.

    Points that repeat their predecessor are dropped.
    """
    # Segments and their right-hand normals; a smooth turn shares the mean of two.
    p = np.array(points, np.float64)
    p = p[np.append(True, np.abs(np.diff(p, axis=0)).max(axis=1) > 1e-9)]
    step = np.diff(p, axis=0)
    length = np.linalg.norm(step, axis=1)
    right = np.stack([step[:, 1], -step[:, 0]], axis=1) / length[:, None]
    smooth = np.einsum("ij,ij->i", right[:-1], right[1:]) > np.cos(np.radians(crease_deg))
    mean = right[:-1] + right[1:]
    # Each segment owns a start and an end point, whose normals agree where the turn is smooth.
    start, end = right.copy(), right.copy()
    start[1:][smooth], end[:-1][smooth] = mean[smooth], mean[smooth]
    normals = np.stack([start, end], axis=1).reshape(-1, 2)
    walked = np.concatenate([[0.0], np.cumsum(length)])
    count = len(step)
    return Profile(
        points=np.stack([p[:-1], p[1:]], axis=1).reshape(-1, 2),
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        lengths=np.stack([walked[:-1], walked[1:]], axis=1).ravel(),
        segments=np.arange(2 * count, dtype=np.intp).reshape(count, 2),
    )


def arc(
    centre: tuple[float, float], radius: float, start_deg: float, end_deg: float, steps: int
) -> Points:
    """Points on a circle; angles from +x towards +y. Torus: -90 to 90; scotia: 270 to 90."""
    angle = np.radians(np.linspace(start_deg, end_deg, steps + 1))
    xs, ys = centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)
    return [(float(x), float(y)) for x, y in zip(xs, ys, strict=True)]


def revolved(shape: Profile, segments: int) -> Geometry:
    """The profile (radius, height) turned about +Y; u runs around at the widest radius."""
    angle = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    around = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
    up = np.array([0.0, 1.0, 0.0])
    positions = _turned(shape.points, around, up)
    normals = _turned(shape.normals, around, up)
    widest = float(shape.points[:, 0].max())
    return patch(positions, normals, _uvs(widest * angle, shape), shape.segments)


def around_rectangle(
    shape: Profile, half_x: float, half_z: float, *, inwards: bool = False
) -> Geometry:
    """The profile (distance from the wall, height) swept around a rectangle, corners mitred.

    `inwards` sweeps the inner side of a court, else the outer side of a block.
    """
    sign = -1.0 if inwards else 1.0
    parts = []
    for side in ("+z", "+x", "-z", "-x"):
        # One side at a time: which way it faces, how far away it lies, how long it is.
        facing_z = side[1] == "z"
        out = sign * (1.0 if side[0] == "+" else -1.0)
        away, across = (half_z, half_x) if facing_z else (half_x, half_z)
        # Each point of the profile is a line from mitre to mitre, longer the further out it lies.
        d, y = shape.points[:, 0], shape.points[:, 1]
        along = (across + sign * d)[:, None] * np.array([-1.0, 1.0])
        depth = np.broadcast_to((sign * out * (away + sign * d))[:, None], along.shape)
        height = np.broadcast_to(y[:, None], along.shape)
        zero = np.zeros_like(along)
        n_out = out * np.broadcast_to(shape.normals[:, :1], along.shape)
        n_up = np.broadcast_to(shape.normals[:, 1:], along.shape)
        # Facing x, the first and the third axis change places.
        order = (along, height, depth) if facing_z else (depth, height, along)
        n_order = (zero, n_up, n_out) if facing_z else (n_out, n_up, zero)
        # Images read from left to right to who stands before each side.
        mirror = out if facing_z else -out
        v = np.broadcast_to(-shape.lengths[:, None], along.shape)
        parts.append(
            patch(
                np.stack(order, axis=-1),
                np.stack(n_order, axis=-1),
                np.stack([mirror * along, v], axis=-1),
                shape.segments,
            )
        )
    return merged(parts)


def around_arch(shape: Profile, radius: float, steps: int) -> Geometry:
    """The profile (distance beyond `radius`, z) swept over a half circle in the xy plane."""
    # From the left springing over the crown to the right one.
    angle = np.linspace(np.pi, 0.0, steps + 1)
    outwards = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    forward = np.array([0.0, 0.0, 1.0])
    positions = _turned(shape.points + np.array([radius, 0.0]), outwards, forward)
    normals = _turned(shape.normals, outwards, forward)
    # u goes by the arc of the moulding's middle.
    middle = radius + float(shape.points[:, 0].mean())
    return patch(positions, normals, _uvs(middle * (np.pi - angle), shape), shape.segments)


def along_x(shape: Profile, low_x: float, high_x: float) -> Geometry:
    """The profile (z, y) swept straight along x, its ends open."""
    x = np.array([low_x, high_x])
    grid = (len(shape.points), 2)
    z, y = (np.broadcast_to(shape.points[:, k : k + 1], grid) for k in (0, 1))
    positions = np.stack([np.broadcast_to(x, grid), y, z], axis=-1)
    n_z, n_y = (np.broadcast_to(shape.normals[:, k : k + 1], grid) for k in (0, 1))
    normals = np.stack([np.zeros(grid), n_y, n_z], axis=-1)
    return patch(positions, normals, _uvs(x, shape), shape.segments)


def _turned(points: F64, first: F64, second: F64) -> F64:
    """points (M, 2) as p0 * first[c] + p1 * second: (M, C, 3)."""
    return points[:, None, :1] * first + points[:, None, 1:] * second


def _uvs(u: F64, shape: Profile) -> F64:
    grid = (len(shape.points), len(u))
    return np.stack(
        [np.broadcast_to(u, grid), np.broadcast_to(-shape.lengths[:, None], grid)], axis=-1
    )
