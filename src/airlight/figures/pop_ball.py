"""A lamp in the middle of a ball of white air, by Monte Carlo that knows the ball's symmetry.

What leaves a ball depends on one number: how far from the middle its line passes, the impact
parameter b, which a photon's last straight path already has. All photons that leave are counted
into rings of b, so that few of them make an image without visible noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..scene.checks import F64

RINGS = 48
_LAST_SCATTERING = 4000


@dataclass(frozen=True, eq=False)
class Profile:
    """`radiance` (rings,), W m^-2 sr^-1, of scattered light at b = radius * (k + 1/2) / rings,
    and its standard error."""

    radius_m: float
    radiance: F64
    error: F64

    def at(self, impact_m: F64) -> F64:
        """Radiance of lines that pass the middle at this distance; 0 beside the ball."""
        middles = self.radius_m * (np.arange(RINGS) + 0.5) / RINGS
        seen = np.interp(impact_m, middles, self.radiance)
        return np.where(impact_m < self.radius_m, seen, 0.0)


def leaving(radius_m: float, sigma_s: float, g: float, photons: int) -> Profile:
    """Scattered light of a lamp of 1 W/sr, air of albedo 1 and scattering `sigma_s` per metre."""
    # Photons leave the light in all directions, and fly until all have left the ball.
    rng = np.random.default_rng(0)
    way = _isotropic(rng, photons)
    place = np.zeros((photons, 3))
    counts = np.zeros(RINGS)
    for order in range(_LAST_SCATTERING):
        # A free flight; who is beyond the radius has left on this one.
        place = place + way * (rng.standard_exponential(len(way)) / sigma_s)[:, None]
        gone = np.einsum("ni,ni->n", place, place) > radius_m**2

        # Photons that were never scattered are the light itself, not what the medium scatters.
        if order:
            impact = np.linalg.norm(np.cross(place[gone], way[gone]), axis=1)
            counts += np.histogram(impact, RINGS, (0.0, radius_m))[0]
        place, way = place[~gone], _turned(way[~gone], g, rng)
        if not len(way):
            break
    edges = np.arange(RINGS + 1) / RINGS
    # A ring sends the radiance L through 4 pi R^2 pi (sin^2 of its edges' angles, b / R).
    watts = 4.0 * np.pi / photons
    area = 4.0 * np.pi**2 * radius_m**2 * np.diff(edges**2)
    return Profile(radius_m, watts * counts / area, watts * np.sqrt(counts) / area)


def _isotropic(rng: np.random.Generator, count: int) -> F64:
    v = rng.standard_normal((count, 3))
    return np.asarray(v / np.linalg.norm(v, axis=1, keepdims=True))


def _turned(way: F64, g: float, rng: np.random.Generator) -> F64:
    """Directions (n, 3) after a scattering by Henyey-Greenstein."""
    # Isotropic scattering needs no frame.
    if g == 0.0:
        return _isotropic(rng, len(way))

    # The inverse of Henyey and Greenstein's cumulative, and any direction across.
    part = (1.0 - g * g) / (1.0 - g + 2.0 * g * rng.random(len(way)))
    cosine = np.clip((1.0 + g * g - part**2) / (2.0 * g), -1.0, 1.0)[:, None]
    across = np.cross(way, _isotropic(rng, len(way)))
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    turned = cosine * way + np.sqrt(1.0 - cosine**2) * across
    return np.asarray(turned / np.linalg.norm(turned, axis=1, keepdims=True))
