"""Phase functions of beams: what an ordinate's part of the sky, not a point, scatters where.

To first order a part with mean cosine c scatters like Henyey-Greenstein with g c, since
convolution multiplies mean cosines (Elek2014 section 5.1). A strong g shows the difference as one
bright spot per ordinate; there the phase function is averaged over a cone with the same c.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .phase import ISOTROPIC, henyey_greenstein

PHASE_TABLE = 256
PREFILTERED_ABOVE = 0.8  # g; below it g c is as good
_LARGEST_G = 0.995  # of the Legendre series; a cone of more than a few degrees hides the rest
_POINT = 1e-7  # 1 - c below which a part is a point


def beam_phase_table(g: ArrayLike, mean_cosine: ArrayLike, *, prefilter: bool = True) -> F64:
    """(N, PHASE_TABLE, channel), sr^-1: for g (channel,) and the N ordinates' mean cosines.

    Entries are at ((1 - mu)/2)^(1/4) = 0 .. 1 in equal steps: dense where the peak is.
    """
    # Fourth powers crowd entries at mu = 1, where the peak is.
    t = np.linspace(0.0, 1.0, PHASE_TABLE)
    mu = 1.0 - 2.0 * t**4
    c = np.asarray(mean_cosine, dtype=np.float64)
    return np.stack([_column(mu, float(k), c, prefilter) for k in np.asarray(g)], axis=-1)


def beam_phase(table: F64, mu: ArrayLike) -> F64:
    """Phase function (..., channel), sr^-1, of one ordinate's table at cosines mu (...)."""
    # The inverse of the table's spacing, then linear between two entries.
    at = (0.5 * (1.0 - np.clip(mu, -1.0, 1.0))) ** 0.25 * (PHASE_TABLE - 1)
    low = np.minimum(at.astype(np.int64), PHASE_TABLE - 2)
    w = (at - low)[..., None]
    return np.asarray((1.0 - w) * table[low] + w * table[low + 1])


def _column(mu: F64, g: float, c: F64, prefilter: bool) -> F64:
    """One channel (N, PHASE_TABLE)."""
    # Only parts with an extent, of sharp phase functions, need an average over the cone.
    plain = henyey_greenstein(mu[None, :], (g * c)[:, None])
    wide = c < 1.0 - _POINT
    if not prefilter or g <= PREFILTERED_ABOVE or not wide.any():
        return plain
    plain[wide] = _over_cones(mu, min(g, _LARGEST_G), c[wide])
    return plain


def _over_cones(mu: F64, g: float, c: F64) -> F64:
    """Henyey-Greenstein averaged over cones of mean cosine c (N,): (N, len(mu)).

    The Legendre series has the coefficients g^l times those of the cone,
    (P_{l-1}(r) - P_{l+1}(r))/((2l+1)(1-r)); r = 2 c - 1 is the cosine of the cone's rim.
    Source: the addition theorem.
    """
    rim = np.clip(2.0 * c - 1.0, -1.0, 1.0)
    # As many orders as it takes for g^l to be nothing.
    order = int(np.ceil(np.log(1e-8) / np.log(g)))
    p_mu, p_rim = _legendre(mu, order + 1), _legendre(rim, order + 1)
    degree = np.arange(1, order + 1)
    kernel = (p_rim[:-2] - p_rim[2:])[:order] / (1.0 - rim)
    series = (g ** degree[:, None] * kernel).T @ p_mu[1 : order + 1]
    return np.asarray(np.maximum(ISOTROPIC * (1.0 + series), 0.0))


def _legendre(x: F64, order: int) -> F64:
    """P_0 .. P_order at x (N,): (order + 1, N)."""
    # Bonnet's recursion.
    p = np.ones((order + 1, x.size))
    p[1] = x
    for n in range(1, order):
        p[n + 1] = ((2 * n + 1) * x * p[n] - n * p[n - 1]) / (n + 1)
    return p
