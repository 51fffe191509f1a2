"""Light scattered once towards the eye along a ray through homogeneous air.

All integrals here are per scattering coefficient and per unit of the light: multiply by sigma_s
(m^-1) and the light's intensity (W/sr) or irradiance (W m^-2) to get radiance. Everything
broadcasts: give lengths a trailing axis of 1 to evaluate RGB coefficients (3,) at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .medium import mean_transmittance
from .phase import henyey_greenstein

F64 = NDArray[np.float64]

# Rays closer to a light than this share of the segment's reach are moved off it: the integral
# diverges like pi/h on the light itself.
NEAREST_PASS = 1e-4


def ray_light_geometry(
    origin: ArrayLike, direction: ArrayLike, light: ArrayLike
) -> tuple[F64, F64]:
    """(h, t_eye) (...), metres, of rays (..., 3) past point lights (..., 3); unit directions.

    h is the distance of the light from the ray; t_eye the origin's parameter where t = 0 is the
    point of the ray closest to the light.
    """
    to_eye = np.asarray(origin, dtype=np.float64) - np.asarray(light, dtype=np.float64)
    d = np.asarray(direction, dtype=np.float64)
    t_eye = np.einsum("...i,...i->...", to_eye, d)
    h = np.linalg.norm(to_eye - t_eye[..., None] * d, axis=-1)
    return np.asarray(h), np.asarray(t_eye)


def point_airlight(
    h_m: ArrayLike,
    t0_m: ArrayLike,
    t1_m: ArrayLike,
    t_eye_m: ArrayLike,
    sigma_t: ArrayLike,
    g: ArrayLike = 0.0,
    nodes: int = 8,
) -> F64:
    """Integral over t in [t0, t1] of f(mu, g) exp(-sigma_t (t - t_eye + r))/r^2, m^-1 sr^-1.

    r = sqrt(h^2 + t^2) is the distance to a point light at height h over t = 0, f
    Henyey-Greenstein. Gauss-Legendre in X = atan2(t, h): equi-angular, so 1/r^2 is exact; `nodes`
    8 is within 3e-3, 16 within 8e-4 for g up to 0.5; a sharper lobe wants 16.
    Source: Nishita et al. 1987 (the integral), Kulla and Fajardo 2012 (equi-angular).
    differs: Billeter2012 section 2 points to Sun et al. 2005, whose difference of two table values
    cancels in float32; here there is no table.
    """
    return _equiangular(h_m, t0_m, t1_m, t_eye_m, sigma_t, g, None, nodes)


def spot_airlight(
    h_m: ArrayLike,
    t0_m: ArrayLike,
    t1_m: ArrayLike,
    t_eye_m: ArrayLike,
    sigma_t: ArrayLike,
    axis_off: ArrayLike,
    axis_along: ArrayLike,
    cos_inner: ArrayLike,
    cos_outer: ArrayLike,
    g: ArrayLike = 0.0,
    nodes: int = 8,
) -> F64:
    """point_airlight of a spot: times its fall-off at every node, m^-1 sr^-1.

    `axis_along` is axis.direction, `axis_off` axis.(unit vector from the light to the closest
    point of the ray). Restrict [t0, t1] with medium.ray_cone_interval first.
    """
    spot = (axis_off, axis_along, cos_inner, cos_outer)
    return _equiangular(h_m, t0_m, t1_m, t_eye_m, sigma_t, g, spot, nodes)


def _equiangular(
    h_m: ArrayLike,
    t0_m: ArrayLike,
    t1_m: ArrayLike,
    t_eye_m: ArrayLike,
    sigma_t: ArrayLike,
    g: ArrayLike,
    spot: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike] | None,
    nodes: int,
) -> F64:
    t0, t1 = np.asarray(t0_m, dtype=np.float64), np.asarray(t1_m, dtype=np.float64)
    sigma, t_eye = np.asarray(sigma_t, dtype=np.float64), np.asarray(t_eye_m, dtype=np.float64)
    reach = np.maximum(np.abs(t0), np.abs(t1))
    h = np.maximum(np.asarray(h_m, dtype=np.float64), NEAREST_PASS * reach + 1e-12)
    x0, x1 = np.arctan2(t0, h), np.arctan2(t1, h)
    middle, half = 0.5 * (x1 + x0), np.maximum(0.5 * (x1 - x0), 0.0)
    total: F64 = np.zeros(np.broadcast_shapes(np.shape(h), np.shape(x0), np.shape(sigma)))
    for node, weight in zip(*np.polynomial.legendre.leggauss(nodes), strict=True):
        x = middle + half * node
        c, s = np.cos(x), np.sin(x)
        # tan X + 1/cos X in the form that does not cancel towards -pi/2
        path = h * np.where(s < 0.0, c / (1.0 - s), (1.0 + s) / c) - t_eye
        # The light travels along (sin X, cos X) = (along the ray, off it); the eye is behind.
        value = henyey_greenstein(-s, g) * np.exp(-sigma * path)
        if spot is not None:
            off, along, inner, outer = (np.asarray(v, dtype=np.float64) for v in spot)
            value = value * spot_falloff(off * c + along * s, inner, outer)
        total = total + weight * value
    return np.asarray(total * half / h)


def spot_falloff(cosine: ArrayLike, cos_inner: ArrayLike, cos_outer: ArrayLike) -> F64:
    """Share of a spot's intensity at `cosine` to its axis: smoothstep from outer to inner."""
    c = np.asarray(cosine, dtype=np.float64)
    inner, outer = np.asarray(cos_inner, dtype=np.float64), np.asarray(cos_outer, dtype=np.float64)
    x = np.clip((c - outer) / np.maximum(inner - outer, 1e-6), 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))


def directional_airlight(
    length_m: ArrayLike,
    light_path_m: ArrayLike,
    light_path_slope: ArrayLike,
    sigma_t: ArrayLike,
    mu: ArrayLike,
    g: ArrayLike = 0.0,
) -> F64:
    """Integral of f(mu, g) exp(-sigma_t (t + s0 + q t)) over t in [0, length], m sr^-1.

    The light travels s0 + q t through the medium to reach the ray at t: `light_path_m` = s0,
    `light_path_slope` = q. mu is the cosine from the light's travel direction to the direction
    towards the eye. Closed: f exp(-sigma s0) T phi1(sigma (1 + q) T).
    Source: Billeter2012 eq. 1, for parallel light in homogeneous air.
    """
    sigma, length = np.asarray(sigma_t, dtype=np.float64), np.asarray(length_m, dtype=np.float64)
    s0, q = (np.asarray(v, dtype=np.float64) for v in (light_path_m, light_path_slope))
    depth = sigma * (1.0 + q) * length
    return np.asarray(
        henyey_greenstein(mu, g) * np.exp(-sigma * s0) * length * mean_transmittance(depth)
    )
