"""How large polygons look from a point, and where they look to be: closed forms."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64


def triangle_solid_angle(corners: ArrayLike) -> F64:
    """Solid angle (...) in sr of triangles (..., 3, 3) seen from the origin; lengths cancel."""
    return np.abs(signed_solid_angle(corners))


def signed_solid_angle(corners: ArrayLike) -> F64:
    """The same, negative where the origin sees corners run counter-clockwise, a triangle's front.

    Summed over 4 pi: how often surfaces go round the origin. Source: VanOosterom1983, eq. 8.
    """
    # The triple product over the sum of VanOosterom1983: tan of half the angle.
    p = np.asarray(corners, dtype=np.float64)
    a, b, c = p[..., 0, :], p[..., 1, :], p[..., 2, :]
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    volume = np.einsum("...i,...i->...", a, np.cross(b, c))
    dots = [np.einsum("...i,...i->...", u, v) for u, v in ((a, b), (a, c), (b, c))]
    spread = la * lb * lc + dots[0] * lc + dots[1] * lb + dots[2] * la
    return np.asarray(2.0 * np.arctan2(volume, spread))


def polygon_solid_angle(corners: ArrayLike) -> F64:
    """Solid angle (...) in sr of convex polygons (..., N, 3) in order, seen from the origin."""
    # A fan of triangles from the first corner.
    p = np.asarray(corners, dtype=np.float64)
    count = p.shape[-2] - 2
    first = np.broadcast_to(p[..., :1, :], (*p.shape[:-2], count, 3))
    fan = np.stack([first, p[..., 1:-1, :], p[..., 2:, :]], axis=-2)
    return np.asarray(triangle_solid_angle(fan).sum(axis=-1))


def polygon_mean_direction(corners: ArrayLike) -> F64:
    """Mean of the unit vectors into convex polygons (..., N, 3): (..., 3), shorter than 1.

    Source: Lambert 1760 (vector irradiance): the integral of direction over solid angle is half
    the sum over edges of (angle the edge spans) x (unit normal of the plane through it).
    """
    # Each edge's angle along the normal of its plane through the origin.
    p = np.asarray(corners, dtype=np.float64)
    q = np.roll(p, -1, axis=-2)
    normal = np.cross(p, q)
    length = np.linalg.norm(normal, axis=-1)
    angle = np.arctan2(length, np.einsum("...i,...i->...", p, q))
    moment = 0.5 * ((angle / np.maximum(length, 1e-300))[..., None] * normal).sum(axis=-2)
    # Corners may be listed either way round: the mean points into the polygon.
    inside = np.einsum("...i,...i->...", moment, p.mean(axis=-2))
    moment = moment * np.sign(inside)[..., None]
    return np.asarray(moment / polygon_solid_angle(p)[..., None])


def quad_mean_square(corners: ArrayLike, nodes: int = 24) -> F64:
    """Mean (3, 3) of the outer square of the unit vectors into a plane parallelogram (4, 3).

    By Gauss-Legendre quadrature of `nodes` squared points; the origin is outside its plane.
    """
    # Points of the parallelogram, at quadrature nodes along its two sides.
    p = np.asarray(corners, dtype=np.float64)
    at, weight = np.polynomial.legendre.leggauss(nodes)
    u, v = (0.5 + 0.5 * x for x in np.meshgrid(at, at))
    points = p[0] + u[..., None] * (p[1] - p[0]) + v[..., None] * (p[3] - p[0])
    distance = np.linalg.norm(points, axis=-1)
    w = points / distance[..., None]
    seen = np.outer(weight, weight) / distance**3  # cos/r^2, without the plane's own distance
    return np.asarray(np.einsum("ij,ija,ijb->ab", seen, w, w) / seen.sum())


def voronoi_cell(directions: ArrayLike, index: int) -> F64:
    """Corners (N, 3), unit, in order, of the spherical Voronoi cell of directions[index].

    `directions` is (M, 3) unit. The cell's corners are the directions that are equally near to
    three of them and to no other nearer.
    """
    d = np.asarray(directions, dtype=np.float64)
    own = d[index]
    # Corners of three directions lie on two of the planes that halve the way to others.
    planes = own - np.delete(d, index, axis=0)
    i, j = np.triu_indices(len(planes), 1)
    meets = np.cross(planes[i], planes[j])
    length = np.linalg.norm(meets, axis=1)
    meets = meets[length > 1e-9] / length[length > 1e-9, None]
    meets = np.concatenate([meets, -meets])
    # Those that no other direction is nearer to, in order around the cell.
    corners = meets[(meets @ planes.T >= -1e-9).all(axis=1)]
    corners = np.unique(np.round(corners, 12), axis=0)
    side = np.cross(own, corners[0])
    azimuth = np.arctan2(corners @ side, corners @ np.cross(side, own))
    return np.asarray(corners[np.argsort(azimuth)])
