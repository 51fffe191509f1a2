"""The polygon or sphere that a group of pieces is, as far as it is one: its analytic part."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..maths.area_light import RIM_CORNERS, rim
from ..maths.sampling import orthonormal_frame
from ..scene.checks import F64
from .pieces import Pieces

MOST_CORNERS = RIM_CORNERS
_FLAT = 0.01  # of its extent a group may lie off its plane
_ROUND = 0.03  # of the radius
_WHOLE = 0.03  # of the area of a sphere that may be missing
_DIRECTIONS = 96
_FULL = 0.75  # of the polygon around one surface that it must fill


class Kind(IntEnum):
    """What the analytic part of an emitter is (twin: area/lighting.wgsl)."""

    POLYGON = 0
    SPHERE = 1
    SAMPLES = 2  # none: the light of the samples themselves


@dataclass(frozen=True, eq=False)
class Shape:
    """`radiance`, W m^-2 sr^-1, of the shape, so that it gives the power of its pieces.

    A polygon has `corners` (n, 3), m, no farther than `radius`, m, from its centre, and glows along
    `normal`; a sphere has its radius.
    """

    kind: Kind
    centre: F64
    normal: F64
    radiance: F64
    radius: float = 0.0
    corners: F64 | None = None


def fitted(group: Pieces, *, is_one: bool = False) -> Shape:
    """The shape of a group: flat ones are the convex polygon around them, at most of 12 corners.

    Where the polygon is larger than the pieces (windows in a wall) it glows as much less; one
    surface (`is_one`) that fills so little of it, a ring or a bent strip, is no polygon.
    """
    light = (group.areas[:, None] * group.radiance).sum(axis=0)  # W m^-2 sr^-1 times m^2
    weight = np.maximum(group.power, 1e-30)[:, None]
    # Middle and normal by power: dark pieces do not pull them.
    centre = (weight * group.positions).sum(axis=0) / weight.sum()
    mean = (weight * group.normals).sum(axis=0) / weight.sum()
    length = float(np.linalg.norm(mean))
    normal = mean / max(length, 1e-30) if length > 1e-6 else np.array((0.0, 1.0, 0.0))
    # Flat within a small part of its size: the polygon around it, unless that is mostly holes.
    points = group.corners.reshape(-1, 3)
    extent = float(np.ptp(points, axis=0).max())
    if length > 0.999 and float(np.ptp(points @ normal)) <= _FLAT * extent:
        corners, area = _outline(points, centre, normal)
        if area > 0.0 and not (is_one and group.areas.sum() < _FULL * area):
            middle = corners.mean(axis=0)
            radius = float(np.linalg.norm(corners - middle, axis=1).max())
            return Shape(Kind.POLYGON, middle, normal, light / area, radius, corners)
    # Not flat: a sphere where it is about one, else only samples can say where its light is from.
    ball = _sphere(group, light)
    return ball or Shape(Kind.SAMPLES, centre, normal, light / max(group.areas.sum(), 1e-30))


def _outline(points: F64, centre: F64, normal: F64) -> tuple[F64, float]:
    """The convex polygon around flat points, and its area; round ones keep their area."""
    # In the plane of the polygon.
    side, up = orthonormal_frame(normal)
    # The convex hull in its plane.
    flat = np.stack([(points - centre) @ side, (points - centre) @ up], axis=1)
    hull = _hull(flat, _DIRECTIONS)
    area = _area(hull)
    if len(hull) > MOST_CORNERS:
        middle = _centroid(hull)
        # Of many corners: a circle where it is round, else fewer corners of the same area.
        far = np.linalg.norm(hull - middle, axis=1)
        if np.ptp(far) < _ROUND * far.mean():
            radius = float(np.sqrt(area / np.pi))
            ring = rim(centre + middle[0] * side + middle[1] * up, normal, radius)
            return ring, area
        hull = _hull(flat, MOST_CORNERS)
        hull = middle + (hull - middle) * np.sqrt(area / max(_area(hull), 1e-30))
    return centre + hull[:, :1] * side + hull[:, 1:] * up, area


def _hull(points: F64, directions: int) -> F64:
    """Corners of the convex hull, counter-clockwise, as far as so many directions tell."""
    # Turned, so that no edge of what is aligned with the axes is at right angles to one of them.
    angle = 2.0 * np.pi * (np.arange(directions) + 0.37) / directions
    towards = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rows = (points @ towards.T).argmax(axis=0)
    corners = points[rows[np.concatenate([[True], rows[1:] != rows[:-1]])]]
    # The first and the last direction may find the same corner.
    if len(corners) > 1 and np.allclose(corners[0], corners[-1]):
        corners = corners[:-1]
    # Where the outline does not turn there is no corner, only a point on an edge.
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    turn = _cross(corners - before, after - corners)
    scale = np.linalg.norm(corners - before, axis=1) * np.linalg.norm(after - corners, axis=1)
    return np.asarray(corners[turn > 1e-4 * np.maximum(scale, 1e-30)])


def _cross(a: F64, b: F64) -> F64:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _area(corners: F64) -> float:
    if len(corners) < 3:
        return 0.0
    return 0.5 * float(_cross(corners, np.roll(corners, -1, axis=0)).sum())


def _centroid(corners: F64) -> F64:
    after = np.roll(corners, -1, axis=0)
    weight = _cross(corners, after)
    total = ((corners + after) * weight[:, None]).sum(axis=0) / (3.0 * weight.sum())
    return np.asarray(total)


def _sphere(group: Pieces, light: F64) -> Shape | None:
    """The sphere that all pieces lie on, facing outwards; its area is theirs."""
    # The box's middle, and the mean distance of corners from it.
    points = group.corners.reshape(-1, 3)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.linalg.norm(points - middle, axis=1).mean())
    if radius <= 0.0:
        return None
    # A sphere only where all corners lie on it, nothing is missing and it shines outwards.
    off = float(np.abs(np.linalg.norm(points - middle, axis=1) - radius).max())
    area = float(group.areas.sum())
    is_whole = abs(area / (4.0 * np.pi * radius**2) - 1.0) < _WHOLE
    faces_out = ((group.positions - middle) * group.normals).sum(axis=1).min() > 0.0
    if off > _ROUND * radius or not is_whole or not faces_out:
        return None
    # Facets lie inside the sphere: of the same area it is a little smaller.
    radius = float(np.sqrt(area / (4.0 * np.pi)))
    return Shape(Kind.SPHERE, middle, np.array((0.0, 1.0, 0.0)), light / area, radius)
