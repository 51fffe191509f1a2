"""The Henyey-Greenstein phase function, per steradian, of travel directions.

mu is the cosine between the directions of travel before and after: g > 0 scatters forward.
Everything broadcasts; g lies in (-1, 1) unless said otherwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]

ISOTROPIC = float(1.0 / (4.0 * np.pi))
HALF_OCTANT_COSINE = float(np.sqrt(0.5))


def isotropic(mu: ArrayLike) -> F64:
    """1/4pi, sr^-1, in the shape of mu."""
    return np.full(np.shape(mu), ISOTROPIC)


def _reach(mu: F64, g: F64) -> F64:
    """sqrt(1 + g^2 - 2 g mu), as a sum of terms of one sign so that nothing cancels."""
    mirrored = np.where(g < 0.0, -mu, mu)
    h = np.abs(g)
    return np.asarray(np.sqrt((1.0 - h) ** 2 + 2.0 * h * (1.0 - mirrored)))


def henyey_greenstein(mu: ArrayLike, g: ArrayLike) -> F64:
    """Phase function, sr^-1; integrates to 1 over the sphere, mean cosine g.

    Source: Henyey and Greenstein 1941.
    """
    m, k = np.asarray(mu, dtype=np.float64), np.asarray(g, dtype=np.float64)
    return np.asarray(ISOTROPIC * (1.0 - k) * (1.0 + k) / _reach(m, k) ** 3)


def henyey_greenstein_cumulative(mu: ArrayLike, g: ArrayLike) -> F64:
    """Share of light scattered to cosines from -1 up to mu, for all |g| <= 1.

    Source: the closed integral in the form (1-g)(1+mu)/(r (1+g+r)), which does not cancel.
    """
    m, k = np.asarray(mu, dtype=np.float64), np.asarray(g, dtype=np.float64)
    m, k = np.broadcast_arrays(m, k)
    r = _reach(m, k)
    safe = np.where(r > 0.0, r, 1.0)
    return np.where(r > 0.0, (1.0 - k) * (1.0 + m) / (safe * (1.0 + k + safe)), 1.0)


def cap_fractions(g: ArrayLike) -> tuple[F64, F64, F64]:
    """Shares (front, side, back) of polar caps 0..45, 45..135 (a quarter each), 135..180 degrees.

    front + 4 side + back = 1. Source: Elek2014 section 4.2, with the stable cumulative.
    """
    k = np.asarray(g, dtype=np.float64)
    back = henyey_greenstein_cumulative(-HALF_OCTANT_COSINE, k)
    side = (henyey_greenstein_cumulative(HALF_OCTANT_COSINE, k) - back) / 4.0
    return 1.0 - 4.0 * side - back, side, back


def sample_henyey_greenstein(u: ArrayLike, g: ArrayLike) -> F64:
    """Cosine mu of a scattered direction from uniform u in [0, 1): the inverse of the cumulative.

    Written as a quotient of polynomials in s = 2u - 1, which needs no special case at g = 0.
    """
    s = 2.0 * np.asarray(u, dtype=np.float64) - 1.0
    k = np.asarray(g, dtype=np.float64)
    top = s + k * (s * s + 3.0) / 2.0 + k * k * s + k**3 * (s * s - 1.0) / 2.0
    return np.clip(top / (1.0 + k * s) ** 2, -1.0, 1.0)


def convolved_anisotropy(g1: ArrayLike, g2: ArrayLike) -> F64:
    """g of two Henyey-Greenstein scatterings in a row: g1 g2, exactly.

    Its Legendre coefficients are g^l, and convolution on the sphere multiplies them.
    """
    return np.asarray(np.asarray(g1, dtype=np.float64) * np.asarray(g2, dtype=np.float64))


def henyey_greenstein_over_cone(mu: ArrayLike, g: float, solid_angle_sr: float) -> F64:
    """Henyey-Greenstein averaged over a cone of directions, sr^-1.

    mu is the cosine to the cone's axis. Legendre series: coefficients g^l times the cone's own,
    (P_{l-1}(c) - P_{l+1}(c))/((2l+1)(1-c)), c the cosine of its half angle. |g| <= 0.995.
    Source: the addition theorem.
    """
    m = np.asarray(mu, dtype=np.float64)
    cosine = 1.0 - solid_angle_sr / (2.0 * np.pi)
    if abs(g) < 1e-9 or solid_angle_sr < 1e-9:
        return henyey_greenstein(m, g)
    order = int(min(4000.0, np.ceil(np.log(1e-10) / np.log(abs(g)))))
    cone = _legendre(np.array([cosine]), order + 1)[:, 0]
    degree = np.arange(1, order + 1)
    kernel = (cone[:-2] - cone[2:])[: len(degree)] / ((2 * degree + 1) * (1.0 - cosine))
    coefficients = np.concatenate([[1.0], (2 * degree + 1) * g**degree * kernel])
    series = np.polynomial.legendre.legval(m, coefficients)
    return np.asarray(ISOTROPIC * series)


def _legendre(x: F64, order: int) -> F64:
    """P_0 .. P_order at x (N,): (order + 1, N)."""
    p = np.ones((order + 1, x.size))
    p[1] = x
    for n in range(1, order):
        p[n + 1] = ((2 * n + 1) * x * p[n] - n * p[n - 1]) / (n + 1)
    return p


def cone_phase_table(g: float, solid_angle_sr: float, count: int = 256) -> F64:
    """henyey_greenstein_over_cone (count,) at sin(theta/2) = 0 .. 1 in equal steps, sr^-1.

    Look it up at x = sqrt((1 - mu)/2), linearly: dense where the peak is, and no arccosine.
    """
    x = np.linspace(0.0, 1.0, count)
    return henyey_greenstein_over_cone(1.0 - 2.0 * x * x, g, solid_angle_sr)
