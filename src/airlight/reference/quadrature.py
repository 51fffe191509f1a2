"""Exact and quadrature answers, float64: what every technique is measured against first.

Gauss-Legendre throughout, in variables that make the integrand smooth. Points and directions
are (..., 3), metres; directions are unit and point where light (or the eye ray) travels.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, cast

import numpy as np

from ..scene.checks import F64, Bounds, Vec3

Array = Any  # what NumPy takes as an array of floats


@lru_cache(maxsize=16)
def gauss_legendre(nodes: int) -> tuple[F64, F64]:
    """Nodes and weights (nodes,) on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    return 0.5 * (x + 1.0), 0.5 * w


def panels(count: int, nodes: int = 8) -> tuple[F64, F64]:
    """Composite nodes and weights (count * nodes,) on [0, 1], for integrands with kinks."""
    x, w = gauss_legendre(nodes)
    start = np.arange(count)[:, None] / count
    return (start + x / count).ravel(), np.tile(w / count, count)


def henyey_greenstein(cosine: Array, g: float) -> F64:
    """The phase function, sr^-1; `cosine` between the two directions of travel, g > 0 forward."""
    spread = 1.0 + g * g - 2.0 * g * np.asarray(cosine, dtype=np.float64)
    return (1.0 - g * g) / (4.0 * math.pi * spread**1.5)


def white_furnace(radiance: Array) -> tuple[F64, F64]:
    """(fluence, irradiance) anywhere in a uniform field that nothing absorbs: 4 pi L, pi L."""
    L = np.asarray(radiance, dtype=np.float64)
    return 4.0 * math.pi * L, math.pi * L


def box_path(origin: Array, direction: Array, bounds: Bounds) -> tuple[F64, F64]:
    """Distances (entry, exit) of rays and a box, m; entry >= 0, equal where a ray misses."""
    # Where each ray meets the six planes; parallel ones give infinities, set right below.
    p, d = np.broadcast_arrays(np.asarray(origin, float), np.asarray(direction, float))
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (np.array(bounds).reshape(2, *(1,) * (p.ndim - 1), 3) - p) / d
    near, far = np.minimum(t[0], t[1]), np.maximum(t[0], t[1])
    # A ray parallel to a pair of faces is inside them for ever, or never.
    inside = (p >= bounds[0]) & (p <= bounds[1])
    near = np.where(d == 0.0, np.where(inside, -np.inf, np.inf), near)
    far = np.where(d == 0.0, np.where(inside, np.inf, -np.inf), far)
    entry = np.maximum(near.max(axis=-1), 0.0)
    leave = far.min(axis=-1)
    hit = leave > entry
    return np.where(hit, entry, 0.0), np.where(hit, leave, 0.0)


def sphere_path(origin: Array, direction: Array, centre: Array, radius: float) -> tuple[F64, F64]:
    """Distances (entry, exit) of rays and a sphere, m; entry >= 0, equal where a ray misses."""
    # A negative discriminant counts as a ray that touches, and so as a miss.
    away = np.asarray(origin, float) - np.asarray(centre, float)
    d = np.asarray(direction, float)
    b = np.sum(away * d, axis=-1)
    root = np.sqrt(np.maximum(b * b - np.sum(away * away, axis=-1) + radius * radius, 0.0))
    entry, leave = np.maximum(-b - root, 0.0), -b + root
    hit = leave > entry
    return np.where(hit, entry, 0.0), np.where(hit, leave, 0.0)


def polygon_irradiance(points: Array, normals: Array, corners: Array, radiance: float = 1.0) -> F64:
    """Irradiance (...), W m^-2, at points from a convex Lambertian polygon, closed form.

    `corners` (n, 3) run counter-clockwise seen from the side that shines. What lies below a
    receiver's horizon is clipped; behind the polygon it is dark. Lambert 1760: L/2 times the
    sum over edges of the angle they subtend times the normal of the wedge, projected.
    """
    # Corners relative to each point, their heights above its horizon, and edges from v to w.
    p, n = np.asarray(points, float), np.asarray(normals, float)
    v = np.asarray(corners, float) - p[..., None, :]
    w = np.roll(v, -1, axis=-2)
    hv, hw = (np.sum(a * n[..., None, :], axis=-1) for a in (v, w))

    # Edges that cross the horizon are cut there.
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = v + (w - v) * np.where(hv != hw, hv / (hv - hw), 0.0)[..., None]
    falls, rises = (hv > 0) & (hw <= 0), (hv <= 0) & (hw > 0)
    start = np.where((hv > 0)[..., None], v, crossing)
    end = np.where((hw > 0)[..., None], w, crossing)
    total = np.sum(np.where((hv > 0) | (hw > 0), _edge(start, end, n), 0.0), axis=-1)
    # Where the polygon dips below the horizon, its outline is closed along the horizon.
    down, up = (np.sum(np.where(way[..., None], crossing, 0.0), axis=-2) for way in (falls, rises))
    clipped = falls.any(axis=-1)
    total += np.where(clipped, _edge(down[..., None, :], up[..., None, :], n)[..., 0], 0.0)
    return cast(F64, np.maximum(0.5 * radiance * -total, 0.0))


def _edge(a: F64, b: F64, n: F64) -> F64:
    """Angle between a and b (..., edges, 3) times the unit normal of their wedge, along n."""
    # The wedge's normal, as long as |a| |b| times the sine of its angle.
    wedge = np.cross(a, b)
    sine = np.linalg.norm(wedge, axis=-1)
    angle = np.arctan2(sine, np.sum(a * b, axis=-1))
    along = np.sum(wedge * n[..., None, :], axis=-1)
    return np.where(sine > 0.0, angle * along / np.maximum(sine, 1e-300), 0.0)


def point_single_scatter(
    origin: Array,
    direction: Array,
    length: Array,
    position: Vec3,
    intensity: float,
    sigma_t: float,
    albedo: float,
    g: float = 0.0,
    *,
    axis: Vec3 | None = None,
    cone_deg: tuple[float, float] = (20.0, 30.0),
    nodes: int = 8,
    count: int = 32,
) -> F64:
    """Radiance (...) from light of a point scattered once on `length` m of each eye ray.

    The ray and the light lie in one homogeneous medium. With `axis` the light is a spot with
    inner and outer half angles `cone_deg` (smoothstep of the cosine between). Equi-angular:
    t = h tan X, dX = h dt/(h^2 + t^2) removes the light's pole (Kulla2012).
    """
    # Closest approach of the ray to the light, and the angles X at the light of its two ends.
    p, d = np.asarray(origin, float), np.asarray(direction, float)
    to_light = np.asarray(position) - p
    closest = np.sum(to_light * d, axis=-1)[..., None]
    h = np.sqrt(np.maximum(np.sum(to_light**2, axis=-1)[..., None] - closest**2, 1e-24))
    first = np.arctan2(-closest, h)
    last = np.arctan2(np.asarray(length, float)[..., None] - closest, h)

    # Nodes equal in angle: distance along the ray, and from the light.
    x, w = panels(count, nodes)
    X = first + (last - first) * x
    t = closest + h * np.tan(X)
    r = h / np.cos(X)
    away = (p[..., None, :] + t[..., None] * d[..., None, :] - position) / r[..., None]
    # The eye looks along d: light reaches it travelling along -d.
    phase = henyey_greenstein(-np.sum(away * d[..., None, :], axis=-1), g)

    # Extinction on both parts of the path, and the falloff of a spot.
    source = intensity * np.exp(-sigma_t * (t + r)) * phase
    if axis is not None:
        source = source * spot_falloff(away @ np.asarray(axis), *cone_deg)
    sigma_s = sigma_t * albedo
    return cast(F64, sigma_s * np.sum(source * w, axis=-1) * ((last - first) / h)[..., 0])


def spot_falloff(cosine: F64, inner_deg: float, outer_deg: float) -> F64:
    """1 inside the inner cone, 0 outside the outer, the smoothstep of the cosine between."""
    inner, outer = math.cos(math.radians(inner_deg)), math.cos(math.radians(outer_deg))
    s = np.clip((cosine - outer) / max(inner - outer, 1e-12), 0.0, 1.0)
    return s * s * (3.0 - 2.0 * s)


def directional_single_scatter(
    origin: Array,
    direction: Array,
    travel: Vec3,
    irradiance: float,
    sigma_t: float,
    albedo: float,
    g: float,
    bounds: Bounds,
    *,
    nodes: int = 8,
    count: int = 64,
) -> F64:
    """Radiance (...) of parallel light along `travel`, scattered once in a box of medium.

    Panels carry the kinks where the light's path changes the face it entered by.
    """
    # Nodes along the eye ray's part inside the box.
    p, d = np.asarray(origin, float), np.asarray(direction, float)
    entry, leave = box_path(p, d, bounds)
    x, w = panels(count, nodes)
    depth = (leave - entry)[..., None] * x
    at = p[..., None, :] + (entry[..., None] + depth)[..., None] * d[..., None, :]

    # From each node back against the light to where it entered.
    _, lit = box_path(at, -np.asarray(travel), bounds)
    through = np.sum(np.exp(-sigma_t * (lit + depth)) * w, axis=-1)
    phase = henyey_greenstein(-np.sum(d * np.asarray(travel), axis=-1), g)
    return cast(F64, sigma_t * albedo * irradiance * phase * through * (leave - entry))


def box_single_scatter_intensity(
    travel: Vec3,
    view: Vec3,
    irradiance: float,
    sigma_t: float,
    albedo: float,
    g: float,
    bounds: Bounds,
    *,
    count: int = 12,
    nodes: int = 6,
) -> float:
    """W sr^-1 that a box of homogeneous medium sends along `view`, scattered once.

    Parallel light of `irradiance` travels along `travel`. A volume integral over
    (count * nodes)^3 points.
    """
    # Nodes in the whole box, each with its share of the volume.
    low, high = np.array(bounds[0]), np.array(bounds[1])
    x, w = panels(count, nodes)
    grid = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1)
    weight = w[:, None, None] * w[None, :, None] * w[None, None, :] * np.prod(high - low)
    at = low + grid * (high - low)

    # Two optical paths: from the light's entry, and on to the eye's side.
    _, lit = box_path(at, -np.asarray(travel, float), bounds)
    _, seen = box_path(at, np.asarray(view, float), bounds)
    phase = henyey_greenstein(np.dot(travel, view), g)
    through = float(np.sum(weight * np.exp(-sigma_t * (lit + seen))))
    return float(sigma_t * albedo * irradiance * phase * through)
