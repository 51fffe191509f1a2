"""Where the light is that stands for a stratum of a thing that glows.

In an image of one sample, and in the first one of a still, it is in the middle; in later ones at
a piece of the stratum that is chosen by its weight.
"""

from __future__ import annotations

import numpy as np

from ..scene.checks import F64, I64
from .segments import Segment

_OFF_PLANE = 0.01  # of its extent, from which on a part is not flat
_GOLDEN, _PLASTIC = 0.6180339887498949, 0.7548776662466927


def chosen_share(index: int, number: int) -> float:
    """The share in [0, 1) of a stratum `number` that sample `index` of a still stands in.

    A still's samples step by the golden ratio, strata by the plastic number's inverse.
    """
    return (0.5 + _GOLDEN * index + _PLASTIC * number) % 1.0


def place_inside(
    points: F64, weight: F64, bodies: I64, segment: Segment | None, share: float | None
) -> F64:
    """Of a light that sends to all sides: inside what glows.

    `points` (n, 3) of pieces, with their `weight` and the numbers of their `bodies`; `segment`:
    where they lie along one. `share` in [0, 1) chooses a piece; None: the middle.
    """
    if segment is not None:
        # Anywhere along the segment.
        along = 0.0 if share is None else 2.0 * share - 1.0
        return np.asarray(segment.middle + along * segment.half)
    if bodies.min() < bodies.max():
        # One of several bodies: between them the others would hide it, or walls.
        return _one_of(bodies, points, weight, share)
    return np.asarray(weight @ points)


def piece_on_surface(
    points: F64, weight: F64, normal: F64, extent: float, share: float | None
) -> int | None:
    """The piece that a light stands on which faces one side, `normal`; None: the middle serves.

    `extent`: how large the stratum is, as `points` are measured. `share` as in `place_inside`.
    """
    if share is not None:
        return up_to(weight, share)
    # A point of the surface itself: the middle of a curved part lies behind it.
    away = points - weight @ points
    if float(np.ptp(away @ normal)) > _OFF_PLANE * extent:
        return int((away**2).sum(axis=1).argmin())
    return None


def _one_of(bodies: I64, points: F64, weight: F64, share: float | None) -> F64:
    """The middle (3,) of that body up to which pieces have this `share` of the weight, or, without
    one, of the body that is nearest to the middle of all."""
    if share is None:
        piece = nearest_to(weight @ points, points)
    else:
        piece = up_to(weight, share)
    own = bodies == bodies[piece]
    return np.asarray(weight[own] @ points[own] / max(float(weight[own].sum()), 1e-300))


def nearest_to(middle: F64, points: F64) -> int:
    """Which of the `points` (n, 3) is nearest to `middle`: the first of those that are as near but
    for rounding, so that it is the same one wherever the scene stands."""
    far = np.linalg.norm(points - middle, axis=1)
    return int(np.argmax(far <= far.min() * (1.0 + 1e-6) + 1e-12))


def up_to(weight: F64, share: float) -> int:
    """The piece up to which all pieces have this `share` of the weight."""
    piece = int(np.searchsorted(np.cumsum(weight), share * weight.sum()))
    return min(piece, len(weight) - 1)
