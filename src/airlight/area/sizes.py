"""What parts of lights with extent are as large as, for media near them, and how far they reach."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..scene.checks import F64, I64
from .pieces import Pieces
from .segments import Segment
from .stretches import principal

_THINNEST = 1e-3  # of its length


@dataclass(frozen=True, eq=False)
class Size:
    """`extent`, metres, as of `LightSample.size`: half the sides of a rectangle, along `tangent`
    and across, or the radius of a ball.
    """

    tangent: F64
    extent: tuple[float, float]


def rectangle(found: Pieces, normal: F64) -> Size:
    """A rectangle of the same area as these pieces, as long and wide as second moments say."""
    # The longest axis of the pieces, in their plane, and how much shorter the other is.
    _, variances, axes = principal(found.corners, found.areas)
    tangent = axes[:, 2] - (axes[:, 2] @ normal) * normal
    aspect = max(math.sqrt(variances[1] / max(variances[2], 1e-300)), _THINNEST)
    half = 0.5 * math.sqrt(float(found.areas.sum()) / aspect)
    return Size(tangent / max(float(np.linalg.norm(tangent)), 1e-300), (half, aspect * half))


def body(found: Pieces, segment: Segment | None) -> Size:
    """A ball of the same area as these pieces, which face out to all sides; none of a long one."""
    radius = 0.0 if segment else math.sqrt(float(found.areas.sum()) / (4.0 * math.pi))
    return Size(np.array((1.0, 0.0, 0.0)), (radius, 0.0))


def own_reach(found: Pieces, bodies: I64, middle: F64) -> F64:
    """(3,) metres along x, y and z: how far the body that holds `middle` reaches from it.

    `bodies` (n,): which of the pieces are connected.
    """
    # The connected body that lies nearest to the point.
    apart = found.corners - middle
    nearest = bodies[int((apart**2).sum(axis=(1, 2)).argmin())]
    return np.asarray(np.abs(apart[bodies == nearest]).max(axis=(0, 1)))
