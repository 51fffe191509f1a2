"""The Henyey-Greenstein phase function, per steradian, of travel directions.

mu is the cosine between the directions of travel before and after: g > 0 scatters forward.
Everything broadcasts; g lies in (-1, 1) unless said otherwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64

ISOTROPIC = float(1.0 / (4.0 * np.pi))
HALF_OCTANT_COSINE = float(np.sqrt(0.5))


def isotropic(mu: ArrayLike) -> F64:
    """1/4pi, sr^-1, in the shape of mu."""
    return np.full(np.shape(mu), ISOTROPIC)


def _reach(mu: F64, g: F64) -> F64:
    """sqrt(1 + g^2 - 2 g mu), as a sum of terms of one sign so that nothing cancels."""
    # Backward lobes are mirrored forward ones.
    mirrored = np.where(g < 0.0, -mu, mu)
    h = np.abs(g)
    return np.asarray(np.sqrt((1.0 - h) ** 2 + 2.0 * h * (1.0 - mirrored)))


def henyey_greenstein(mu: ArrayLike, g: ArrayLike) -> F64:
    """Phase function, sr^-1; integrates to 1 over the sphere, mean cosine g.

    Source: Henyey1941.
    """
    m, k = np.asarray(mu, dtype=np.float64), np.asarray(g, dtype=np.float64)
    return np.asarray(ISOTROPIC * (1.0 - k) * (1.0 + k) / _reach(m, k) ** 3)


def scattering_phase(mu: ArrayLike, g: ArrayLike) -> F64:
    """The phase function of media, sr^-1: what single scattering calls.

    Twin: scattering_phase in wgsl/phase.wgsl; another phase function is written in these two
    alone. What expands it (beams, lobes, the reduced medium) knows its mean cosine g only.
    """
    return henyey_greenstein(mu, g)


def henyey_greenstein_cumulative(mu: ArrayLike, g: ArrayLike) -> F64:
    """Share of light scattered to cosines from -1 up to mu, for all |g| <= 1.

    Source: the closed integral in the form (1-g)(1+mu)/(r (1+g+r)), which does not cancel.
    """
    # The closed form, where the distance of the two directions is not 0.
    m, k = np.asarray(mu, dtype=np.float64), np.asarray(g, dtype=np.float64)
    m, k = np.broadcast_arrays(m, k)
    r = _reach(m, k)
    safe = np.where(r > 0.0, r, 1.0)
    return np.where(r > 0.0, (1.0 - k) * (1.0 + m) / (safe * (1.0 + k + safe)), 1.0)


def cap_fractions(g: ArrayLike) -> tuple[F64, F64, F64]:
    """Shares (front, side, back) of polar caps 0..45, 45..135 (a quarter each), 135..180 degrees.

    front + 4 side + back = 1. Source: Elek2014 section 4.2, with the stable cumulative.
    """
    # Caps of 45 degrees ahead and behind; the rest is split among four sides.
    k = np.asarray(g, dtype=np.float64)
    back = henyey_greenstein_cumulative(-HALF_OCTANT_COSINE, k)
    side = (henyey_greenstein_cumulative(HALF_OCTANT_COSINE, k) - back) / 4.0
    return 1.0 - 4.0 * side - back, side, back
