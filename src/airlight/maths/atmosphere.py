"""Sunlight through the air of the Earth: radiance of a clear sky, and what of the sun arrives.

Air, haze and ozone lie in spherical shells. Single scattering is integrated along each view ray
(Nishita1993); what is scattered more often is isotropic and in balance with its neighbourhood
(Hillaire2020, eq. 5 to 10), light from the ground included. Everything is computed at eight
wavelengths, then taken to linear Rec.709 (`sunlight`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .arrays import F64
from .sampling import fibonacci_sphere

GROUND_M, TOP_M = 6_360_000.0, 6_460_000.0
WAVELENGTHS_NM = np.arange(390.0, 711.0, 45.0)
"""Of the eight: trapezia between them are .5 % from 5 nm steps in the luminance of sunlight."""
_AIR_M, _HAZE_M = 8000.0, 1200.0  # scale heights
_OZONE_MIDDLE_M, _OZONE_HALF_M = 25_000.0, 15_000.0  # a tent
_AIR_AT_1_UM = 1.24062e-6  # m^-1 (Bruneton2017)
_HAZE_ALBEDO, _HAZE_G, _HAZE_EXPONENT = 0.9, 0.8, 1.3  # Bruneton2017; Preetham1999, A.1
_OZONE_CM = 0.35
# Ozone's absorption, cm^-1 (Preetham1999, table 2), between these wavelengths linear.
_OZONE_NM = (380, 440, 470, 500, 520, 550, 575, 600, 630, 650, 680, 700, 750, 780)
_OZONE = (0.0, 0.003, 0.009, 0.030, 0.048, 0.085, 0.12, 0.125, 0.09, 0.067, 0.036, 0.023, 0.01, 0.0)
# Against three times as many of each: within 1 % where the sun is up, 3 % (at most 13 % in single
# views) in twilight.
_STEPS, _COLUMN_STEPS, _DIRECTIONS, _MEAN_STEPS = 32, 40, 32, 16
_HEIGHTS, _ANGLES = 12, 5


@dataclass(frozen=True)
class Air:
    """What the air is made of, and the ground's albedo.

    `turbidity`: the optical depth of air and haze at 550 nm over that of air alone; 1 is without
    haze, 2 very clear, 3 clear, 6 hazy.
    """

    turbidity: float = 3.0
    ground: float = 0.2

    @property
    def scattering(self) -> F64:
        """(2, W) of air and haze at sea level, m^-1."""
        return self._parts[:2] * ((1.0,), (_HAZE_ALBEDO,))

    @property
    def _parts(self) -> F64:
        """Extinction (3, W), m^-1, of air, haze and ozone where each has density 1."""
        # Rayleigh scattering falls with the fourth power of the wavelength.
        micrometres = WAVELENGTHS_NM * 1e-3
        air = _AIR_AT_1_UM * micrometres**-4.0

        # Haze makes up the optical depth that the turbidity has beyond the air's own.
        at_550 = (self.turbidity - 1.0) * _AIR_AT_1_UM * 0.55**-4.0 * _AIR_M / _HAZE_M
        haze = at_550 * (micrometres / 0.55) ** -_HAZE_EXPONENT

        # Ozone's whole column over the area of its tent, which is the half width.
        ozone = np.interp(WAVELENGTHS_NM, _OZONE_NM, _OZONE) * _OZONE_CM / _OZONE_HALF_M
        return np.stack([air, haze, ozone])

    def extinction(self, densities: F64) -> F64:
        """(..., W) of densities (..., 3), m^-1; of columns (..., 3), m, the optical depth."""
        return np.asarray(densities @ self._parts)


def densities(height_m: F64) -> F64:
    """(..., 3) of air, haze and ozone at heights (...,), over those where each is densest."""
    ozone = np.maximum(0.0, 1.0 - np.abs(height_m - _OZONE_MIDDLE_M) / _OZONE_HALF_M)
    return np.stack([np.exp(-height_m / _AIR_M), np.exp(-height_m / _HAZE_M), ozone], axis=-1)


def columns_out(height_m: F64, cosine: F64) -> F64:
    """(..., 3) m, densities summed from heights along rays of zenith `cosine` out of the air.

    Infinite where the ray meets the ground.
    """
    r, cosine = np.broadcast_arrays(GROUND_M + height_m, cosine)
    length = _to_sphere(r, cosine, TOP_M)
    # Steps grow with the cube: most of the air is near where the ray begins.
    edges = np.linspace(0.0, 1.0, _COLUMN_STEPS + 1) ** 3
    at = length[..., None] * (edges[:-1] + edges[1:]) / 2.0
    heights = np.sqrt(r[..., None] ** 2 + at**2 + 2.0 * at * (r * cosine)[..., None]) - GROUND_M
    widths = length[..., None] * np.diff(edges)
    # No ray that leaves goes below the ground; those that do would overflow there.
    columns = (densities(np.maximum(heights, 0.0)) * widths[..., None]).sum(axis=-2)
    return np.where(_meets_ground(r, cosine)[..., None], np.inf, columns)


def transmittance_out(air: Air, height_m: F64, cosine: F64) -> F64:
    """(..., W) of rays out of the air; 0 where they meet the ground."""
    # Columns that meet the ground are infinite, and let no light pass.
    columns = columns_out(height_m, cosine)
    free = np.isfinite(columns)
    return np.asarray(
        np.exp(-air.extinction(np.where(free, columns, 0.0))) * free.all(axis=-1, keepdims=True)
    )


@dataclass(frozen=True, eq=False)
class SkyParts:
    """Radiance of the sky over the sun's irradiance outside the air, sr^-1, without the phase
    functions of what air (..., W) and haze (..., W) scatter once; `often`: all other light."""

    air: F64
    haze: F64
    often: F64


def sky_parts(air: Air, elevation: F64, from_sun: F64, sun_elevation: float) -> SkyParts:
    """Of views (V,) from the ground by elevation and azimuth from the sun's, all in radians."""
    towards = np.stack(
        [np.cos(elevation) * np.cos(from_sun), np.sin(elevation)], axis=-1
    )  # along the sun's azimuth, up; what is across does not matter
    cosine = np.sin(elevation)
    eye = np.full_like(cosine, GROUND_M + 1.0)
    length = _to_sphere(eye, cosine, TOP_M)
    # Middles of steps that grow with the distance, and the radius there by the law of cosines.
    edges = np.linspace(0.0, 1.0, _STEPS + 1) ** 2
    at = length[:, None] * (edges[:-1] + edges[1:]) / 2.0
    r = np.sqrt(eye[:, None] ** 2 + at**2 + 2.0 * at * (eye * cosine)[:, None])
    # The sun's height over the horizon of each point, which the Earth's roundness turns.
    sun = np.array([np.cos(sun_elevation), np.sin(sun_elevation)])
    up = at * (towards @ sun)[:, None] + eye[:, None] * sun[1]
    sun_cosine = np.clip(up / r, -1.0, 1.0)
    return _marched(air, r - GROUND_M, length[:, None] * np.diff(edges), sun_cosine, sun_elevation)


def _marched(
    air: Air, heights: F64, widths: F64, sun_cosine: F64, sun_elevation: float
) -> SkyParts:
    """The three parts along rays of steps (V, S): heights and widths, m, cosines to the sun."""
    # Optical depth of each step, and what the steps before it transmit.
    at_points = densities(heights)
    depth = air.extinction(at_points * widths[..., None])
    before = np.exp(-(np.cumsum(depth, axis=1) - depth))
    # Within a step the source is constant: what it sends through the rest of the step.
    share = before * -np.expm1(-depth) / np.maximum(depth, 1e-300) * widths[..., None]

    # Air and haze apart, because each has a phase function of its own.
    scattering = at_points[..., :2, None] * air.scattering
    direct = transmittance_out(air, heights, sun_cosine) * share
    often = often_scattered(air, heights, sun_cosine, sun_elevation) * share
    return SkyParts(
        (direct * scattering[..., 0, :]).sum(axis=1),
        (direct * scattering[..., 1, :]).sum(axis=1),
        (often * scattering.sum(axis=-2)).sum(axis=1),
    )


def often_scattered(air: Air, heights: F64, sun_cosine: F64, sun_elevation: float) -> F64:
    """Mean radiance (..., W) of light scattered at least once, over the sun's irradiance, sr^-1.

    Source: Hillaire2020, eq. 5 to 10. It is a table of heights and of the few sun angles that
    it has in one sky, read linearly.
    """
    # Heights are dense near the ground; the sun's angle differs little over one sky's points.
    rows = np.linspace(0.0, 1.0, _HEIGHTS) ** 2 * 0.6 * (TOP_M - GROUND_M)
    angles = np.pi / 2.0 - sun_elevation + np.radians(np.linspace(-8.0, 8.0, _ANGLES))
    table = _mean_radiance(air, *np.meshgrid(rows, np.cos(angles), indexing="ij"))
    row = np.interp(heights, rows, np.arange(len(rows)))
    column = np.interp(np.arccos(sun_cosine), angles, np.arange(len(angles)))
    return bilinear(table, row, column)


def _mean_radiance(air: Air, height_m: F64, sun_cosine: F64) -> F64:
    """`often_scattered` at heights (H, A), of cosines (H, A) to the sun: (H, A, W), by eq. 10."""
    # Directions all around each point, and how far they go: to the ground, or out of the air.
    towards = fibonacci_sphere(_DIRECTIONS)
    shape = (*height_m.shape, _DIRECTIONS)
    r = np.broadcast_to((GROUND_M + height_m)[..., None], shape)
    cosine = np.broadcast_to(towards[:, 1], shape)
    hits = _meets_ground(r, cosine)
    length = np.where(hits, _to_ground(r, cosine), _to_sphere(r, cosine, TOP_M))
    # Steps are short near the point, where most of the light comes from.
    edges = np.linspace(0.0, 1.0, _MEAN_STEPS + 1) ** 2
    at = length[..., None] * (edges[:-1] + edges[1:]) / 2.0
    # Positions beside the point's own vertical, and the sun in the plane of x and y.
    radius = np.sqrt(r[..., None] ** 2 + at**2 + 2.0 * at * (r * cosine)[..., None])
    sun_x = np.sqrt(np.maximum(0.0, 1.0 - sun_cosine**2))[..., None]
    to_sun = sun_x * towards[:, 0] + sun_cosine[..., None] * towards[:, 1]
    up = at * to_sun[..., None] + (r * sun_cosine[..., None])[..., None]
    seen_cosine = np.clip(up / radius, -1.0, 1.0)
    widths = length[..., None] * np.diff(edges)
    # The optical depth of each step, the transmittance of those before it, and what it scatters.
    at_points = densities(np.maximum(radius - GROUND_M, 0.0))
    depth = air.extinction(at_points * widths[..., None])
    before = np.exp(-(np.cumsum(depth, axis=-2) - depth))
    share = before * -np.expm1(-depth) / np.maximum(depth, 1e-300) * widths[..., None]
    scattered = share * (at_points[..., :2] @ air.scattering)
    lit = transmittance_out(air, np.maximum(radius - GROUND_M, 0.0), seen_cosine)
    once = (scattered * lit).sum(axis=-2) / (4.0 * np.pi)
    # The ground where rays end, lit by the sun alone.
    end = length * to_sun + r * sun_cosine[..., None]
    end_cosine = np.clip(end / GROUND_M, 0.0, 1.0)
    arrives = transmittance_out(air, np.zeros_like(end_cosine), end_cosine)
    ground = arrives * (air.ground / np.pi * end_cosine * hits)[..., None]
    # Light of the second order, and the share that each order hands on to the next: eq. 10 is the
    # sum of the geometric series (Hillaire2020).
    second = (once + ground * np.exp(-depth.sum(axis=-2))).mean(axis=-2)
    again = scattered.sum(axis=-2).mean(axis=-2)
    return np.asarray(second / (1.0 - again))


def air_phase(cosine: F64) -> F64:
    """Rayleigh's, sr^-1."""
    return np.asarray(3.0 / (16.0 * np.pi) * (1.0 + cosine**2))


def haze_phase(cosine: F64) -> F64:
    """Cornette1992, sr^-1, with g .8."""
    # A peak like Henyey and Greenstein's, times Rayleigh's factor.
    g = _HAZE_G
    front = 3.0 / (8.0 * np.pi) * (1.0 - g * g) / (2.0 + g * g)
    return np.asarray(front * (1.0 + cosine**2) / (1.0 + g * g - 2.0 * g * cosine) ** 1.5)


def bilinear(table: F64, row: F64, column: F64) -> F64:
    """(..., K) of a table (R, C, K) between its entries; `row`, `column` within it."""
    # The entry before, and the shares of the one after it along rows and columns.
    r = np.clip(row.astype(np.int64), 0, table.shape[0] - 2)
    c = np.clip(column.astype(np.int64), 0, table.shape[1] - 2)
    u, v = (row - r)[..., None], (column - c)[..., None]
    upper = table[r, c] * (1.0 - v) + table[r, c + 1] * v
    lower = table[r + 1, c] * (1.0 - v) + table[r + 1, c + 1] * v
    return np.asarray(upper * (1.0 - u) + lower * u)


def _to_sphere(r: F64, cosine: F64, radius: float) -> F64:
    """The distance from inside to a sphere around the Earth's centre, metres."""
    return np.asarray(-r * cosine + np.sqrt((r * cosine) ** 2 + radius**2 - r**2))


def _to_ground(r: F64, cosine: F64) -> F64:
    inside = np.maximum((r * cosine) ** 2 + GROUND_M**2 - r**2, 0.0)
    return np.asarray(np.maximum(-r * cosine - np.sqrt(inside), 0.0))


def _meets_ground(r: F64, cosine: F64) -> NDArray[np.bool_]:
    return np.asarray((cosine < 0.0) & ((r * cosine) ** 2 + GROUND_M**2 - r**2 > 0.0))
