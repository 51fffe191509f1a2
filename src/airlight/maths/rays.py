"""Rays against triangles, each against all: the truth that hierarchies of boxes are held to.

The test is that of Moeller1997, in float64, from either side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64, I64

_MOST_PAIRS = 1 << 19  # of rays and triangles that are tested at once


@dataclass(frozen=True)
class RayHits:
    """Of each ray: `t` (infinite where it hits nothing), `triangle` (-1), `bary` (..., 2).

    `bary` are the shares of the triangle's second and third corner.
    """

    t: F64
    triangle: I64
    bary: F64


def nearest_hit(
    origin: ArrayLike,
    direction: ArrayLike,
    corners: ArrayLike,
    t_min: float = 0.0,
    t_max: float = np.inf,
) -> RayHits:
    """What rays (N, 3) of directions of any length meet first of `corners` (T, 3, 3).

    The point of a hit is origin + t * direction, with t_min <= t < t_max. Triangles that a ray
    lies within are not hit, nor those without an area.
    """
    o, d = (np.asarray(x, dtype=np.float64) for x in (origin, direction))
    p = np.asarray(corners, dtype=np.float64)
    found = RayHits(np.full(len(o), np.inf), np.full(len(o), -1), np.zeros((len(o), 2)))
    if not len(p):
        return found
    # All pairs of rays and triangles, some rays at a time so that they fit in memory.
    step = max(1, _MOST_PAIRS // len(p))
    for first in range(0, len(o), step):
        part = slice(first, first + step)
        t, u, v = triangle_distances(o[part], d[part], p)
        t[~((t >= t_min) & (t < t_max))] = np.inf
        # The nearest of each ray's hits; none leaves t = inf, triangle -1.
        nearest = t.argmin(axis=1)
        rows = np.arange(len(nearest))
        found.t[part] = t[rows, nearest]
        is_hit = np.isfinite(found.t[part])
        found.triangle[part] = np.where(is_hit, nearest, -1)
        shares = np.stack([u[rows, nearest], v[rows, nearest]], axis=1)
        found.bary[part] = np.where(is_hit[:, None], shares, 0.0)
    return found


def any_hit(
    origin: ArrayLike,
    direction: ArrayLike,
    corners: ArrayLike,
    t_min: float = 0.0,
    t_max: float = np.inf,
) -> NDArray[np.bool_]:
    """Whether rays meet any of the triangles; as `nearest_hit`."""
    return nearest_hit(origin, direction, corners, t_min, t_max).triangle >= 0


def triangle_distances(origin: F64, direction: F64, corners: F64) -> tuple[F64, F64, F64]:
    """t and the shares of the second and third corner, (N, T) each; t infinite where missed."""
    # Moeller1997: Cramer's rule, in triple products of ray, edges and corner.
    edge_1, edge_2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction[:, None], edge_2[None])
    whole = (across * edge_1).sum(axis=2)
    from_corner = origin[:, None] - corners[None, :, 0]
    turned = np.cross(from_corner, edge_1[None])
    with np.errstate(divide="ignore", invalid="ignore"):
        u = (across * from_corner).sum(axis=2) / whole
        v = (turned * direction[:, None]).sum(axis=2) / whole
        t = (turned * edge_2[None]).sum(axis=2) / whole
        is_hit = (whole != 0.0) & (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
    return np.where(is_hit, t, np.inf), u, v
