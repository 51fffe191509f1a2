"""Threads: bodies far longer than thick, however bent, of many facets: tubes of few sides."""

from __future__ import annotations

import numpy as np

from ..scene.checks import F64, I64
from .stretches import is_long, stretches

_MOST_FACES = 6
"""Faces of a body that are lights of their own: a box has six."""
_MOST_BENDS = 32
_SLENDER = 6.0
"""Lengths over diameters, as far as area and volume tell, from which on a body may be a thread."""
_MOST_BODIES = 64
_MOST_OFF = 0.1  # of the area that may lie in stretches that are not long


def threads_joined(points: F64, part: I64, body: I64) -> I64:
    """Numbers (T,) of smooth parts, `part`, with those of each thread made one.

    `points` (T, 3, 3), m: triangles; `body` (T,): which of them are connected. Each facet of a tube
    would be a light, and none of them a polygon.
    """
    # Areas of triangles, and of the bodies that they make.
    doubled = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    areas = 0.5 * np.linalg.norm(doubled, axis=1)
    total = np.bincount(body, areas)
    # Volumes about the middle of each body: an open tube has about that of a closed one.
    centres = points.mean(axis=1)
    sums = np.stack([np.bincount(body, areas * column) for column in centres.T], axis=1)
    middle = sums / np.maximum(total, 1e-300)[:, None]
    volume = np.bincount(body, ((centres - middle[body]) * doubled).sum(axis=1)) / 6.0
    # Of a round rod 4 V / A is the diameter: a thread has many faces and is long for it.
    diameter = 4.0 * np.abs(volume) / np.maximum(total, 1e-300)
    faces = np.bincount(np.unique(np.stack([body, part]), axis=1)[0], minlength=len(total))
    may_be = (faces > _MOST_FACES) & (total > np.pi * _SLENDER * diameter**2)
    joined = part.copy()
    # The largest of them are looked at; a thread's parts take the least of their numbers.
    largest = np.flatnonzero(may_be)[np.argsort(-total[may_be], kind="stable")][:_MOST_BODIES]
    for one in largest:
        rows = np.flatnonzero(body == one)
        if _is_thread(points[rows], areas[rows]):
            joined[rows] = joined[rows].min()
    return np.asarray(np.unique(joined, return_inverse=True)[1].reshape(-1))


def _is_thread(corners: F64, areas: F64) -> bool:
    """Whether nearly all of a body lies in long stretches, of some number of them."""
    count = 1
    while count <= _MOST_BENDS:
        # Bends are few along a thread: so many stretches hold nearly all of its area.
        parts = stretches(corners, areas, count)
        off = [
            float(areas[rows].sum()) for rows in parts if not is_long(corners[rows], areas[rows])
        ]
        if sum(off) <= _MOST_OFF * float(areas.sum()):
            return True
        count *= 2
    return False
