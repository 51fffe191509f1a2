"""Attenuation along straight paths, and where rays meet boxes, spheres and cones.

Everything broadcasts: per-channel coefficients need a trailing channel axis on the lengths.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64

# Below this the quotients are taken from their series; float32 agrees on both sides.
SERIES_BELOW = 0.02


def optical_depth(sigma_t: ArrayLike, length_m: ArrayLike) -> F64:
    """sigma_t (m^-1) times length (m), dimensionless."""
    return np.asarray(
        np.asarray(sigma_t, dtype=np.float64) * np.asarray(length_m, dtype=np.float64)
    )


def transmittance(sigma_t: ArrayLike, length_m: ArrayLike) -> F64:
    """Share of light left after `length_m` of constant extinction, in [0, 1].

    Source: Beer-Lambert.
    """
    return np.exp(-optical_depth(sigma_t, length_m))


def mean_transmittance(x: ArrayLike) -> F64:
    """phi1(x) = (1 - exp(-x))/x, the mean of exp(-t) over t in [0, x]; 1 at 0; any sign of x."""
    # The quotient's series where 1 - exp(-x) would lose its digits.
    depth = np.asarray(x, dtype=np.float64)
    small = np.abs(depth) < SERIES_BELOW
    safe = np.where(small, 1.0, depth)
    t = np.where(small, depth, 0.0)
    series = 1.0 - t / 2.0 * (1.0 - t / 3.0 * (1.0 - t / 4.0 * (1.0 - t / 5.0)))
    return np.where(small, series, -np.expm1(-safe) / safe)


def transmittance_from_within(depth: ArrayLike, inner: ArrayLike) -> F64:
    """Transmittance from a light that fills a volume to where it is small; `depth`: optical, from
    its middle.

    It reaches `inner` optical depths ahead of its middle and behind it, at most to where its medium
    ends: exp(-depth) sinh(x) / x with x = min(inner, depth), the mean over a slab. A ball of one
    extinction sigma and radius r has this within 2 % for x = sigma sqrt(3/5) r, the root mean
    square of distances from its middle, up to x = 2, and .86 of it at 4. Source: ours.
    """
    depth = np.asarray(depth, np.float64)
    within = np.minimum(depth, inner)
    return np.asarray(np.exp(within - depth) * mean_transmittance(2.0 * within), np.float64)


def mean_absorption_depth(x: ArrayLike) -> F64:
    """m(x) = 1/x - exp(-x)/(1 - exp(-x)): where in [0, 1] a path of depth x loses its light.

    The mean position, as a share of the path, of what is absorbed on it; 1/2 at 0, 1/x for thick.
    """
    # The same; its difference of two large numbers cancels earlier.
    depth = np.asarray(x, dtype=np.float64)
    small = depth < 20.0 * SERIES_BELOW
    safe = np.where(small, 1.0, depth)
    t = np.where(small, depth, 0.0)
    series = 0.5 - t / 12.0 * (1.0 - t * t / 60.0 * (1.0 - t * t / 42.0 * (1.0 - t * t / 40.0)))
    return np.where(small, series, 1.0 / safe - 1.0 / np.expm1(np.minimum(safe, 700.0)))


def ray_box_interval(
    origin: ArrayLike, direction: ArrayLike, low: ArrayLike, high: ArrayLike
) -> tuple[F64, F64]:
    """Ray parameters (t0, t1) (...) between which origin + t direction is inside a box.

    (..., 3) each, t in units of |direction|; t0 may be negative; t0 > t1 where the ray misses.
    Source: Kay1986 (slabs); a component 0 leaves its slab out or misses.
    """
    # Slab by slab, with inverse directions where there are any.
    o, d = np.asarray(origin, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    still = d == 0.0
    inverse = 1.0 / np.where(still, 1.0, d)
    a = (np.asarray(low, dtype=np.float64) - o) * inverse
    b = (np.asarray(high, dtype=np.float64) - o) * inverse
    inside = (np.asarray(low) <= o) & (o <= np.asarray(high))
    # A ray along a slab is inside it all the way, or never.
    near = np.where(still, np.where(inside, -np.inf, np.inf), np.minimum(a, b))
    far = np.where(still, np.where(inside, np.inf, -np.inf), np.maximum(a, b))
    return near.max(axis=-1), far.min(axis=-1)


def transmittance_in_box(
    sigma_t: ArrayLike,
    origin: ArrayLike,
    direction: ArrayLike,
    length_m: ArrayLike,
    low: ArrayLike,
    high: ArrayLike,
) -> F64:
    """Transmittance (..., channel) of the first `length_m` of a ray through a homogeneous box.

    `sigma_t` (channel,), m^-1; unit `direction` (..., 3); the medium ends at the box's sides.
    """
    t0, t1 = ray_box_interval(origin, direction, low, high)
    inside = np.minimum(t1, length_m) - np.maximum(t0, 0.0)
    return transmittance(sigma_t, np.maximum(inside, 0.0)[..., None])


def ray_sphere_interval(
    origin: ArrayLike, direction: ArrayLike, centre: ArrayLike, radius_m: ArrayLike
) -> tuple[F64, F64]:
    """Distances (t0, t1) (...), metres, between which a ray of unit direction is inside a sphere.

    t0 > t1 where it misses. The half chord is computed from the ray's distance to the centre, so
    that far spheres keep their digits. Source: Haines2019 (Ray Tracing Gems, chapter 7).
    """
    # The ray's point nearest to the centre, and half the chord around it.
    o, d = np.asarray(origin, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    to_centre = np.asarray(centre, dtype=np.float64) - o
    middle = np.einsum("...i,...i->...", to_centre, d)
    off_axis = to_centre - middle[..., None] * d
    left = np.asarray(radius_m, dtype=np.float64) ** 2 - (off_axis**2).sum(axis=-1)
    half = np.sqrt(np.maximum(left, 0.0))
    missed = left < 0.0
    return np.where(missed, np.inf, middle - half), np.where(missed, -np.inf, middle + half)


def ray_light_geometry(
    origin: ArrayLike, direction: ArrayLike, light: ArrayLike
) -> tuple[F64, F64]:
    """(h, t_eye) (...), metres, of rays (..., 3) past point lights (..., 3); unit directions.

    h is the distance of the light from the ray; t_eye is the origin's parameter where t = 0 is the
    point of the ray closest to the light.
    """
    # The foot of the perpendicular from the light splits the ray.
    to_eye = np.asarray(origin, dtype=np.float64) - np.asarray(light, dtype=np.float64)
    d = np.asarray(direction, dtype=np.float64)
    t_eye = np.einsum("...i,...i->...", to_eye, d)
    h = np.linalg.norm(to_eye - t_eye[..., None] * d, axis=-1)
    return np.asarray(h), np.asarray(t_eye)


def ray_cone_interval(
    origin: ArrayLike,
    direction: ArrayLike,
    apex: ArrayLike,
    axis: ArrayLike,
    cos_half_angle: ArrayLike,
) -> tuple[F64, F64]:
    """Distances (t0, t1) (...), metres, between which a ray is inside a solid cone.

    Half angle below 90 degrees; unit `direction` and `axis`; an end may be infinite; t0 > t1 where
    the ray misses. The cone is convex, so one interval is all there is.
    """
    # The ray relative to the cone's apex, and both directions along its axis.
    d, axis_ = np.asarray(direction, dtype=np.float64), np.asarray(axis, dtype=np.float64)
    o = np.asarray(origin, dtype=np.float64) - np.asarray(apex, dtype=np.float64)
    c2 = np.asarray(cos_half_angle, dtype=np.float64) ** 2
    da, oa = np.einsum("...i,...i->...", d, axis_), np.einsum("...i,...i->...", o, axis_)
    # (p.axis)^2 >= cos^2 |p|^2 along p = o + t d: qa t^2 + 2 qb t + qc >= 0.
    qa = da * da - c2
    qa = np.where(np.abs(qa) < 1e-12, 1e-12, qa)
    qb = oa * da - c2 * np.einsum("...i,...i->...", o, d)
    qc = oa * oa - c2 * np.einsum("...i,...i->...", o, o)
    discriminant = qb * qb - qa * qc
    # The stable form of the quadratic's roots: none is a difference of nearly equal numbers.
    q = -(qb + np.where(qb < 0.0, -1.0, 1.0) * np.sqrt(np.maximum(discriminant, 0.0)))
    r0, r1 = q / qa, qc / np.where(q == 0.0, 1e-300, q)
    low, high = np.minimum(r0, r1), np.maximum(r0, r1)
    # At a larger angle to the axis the ray has a chord, if of the nappe ahead; at a smaller one it
    # stays inside for good, or was inside from ever.
    chord = (qa < 0.0) & (discriminant > 0.0) & (oa + 0.5 * (low + high) * da >= 0.0)
    opens = qa > 0.0
    t0 = np.where(opens, np.where(da > 0.0, high, -np.inf), np.where(chord, low, np.inf))
    t1 = np.where(opens, np.where(da > 0.0, np.inf, low), np.where(chord, high, -np.inf))
    return t0, t1
