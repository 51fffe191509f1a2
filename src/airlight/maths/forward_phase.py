"""Where light goes that was scattered forwards before, and is scattered again.

A similar isotropic medium (scatter.similar) counts light scattered forwards as not scattered; what
has been at least once, m times on the mean, scatters broader than the medium's own phase function.
Source: ours (three sources of anisotropic air; measured against Monte Carlo).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .phase import ISOTROPIC, henyey_greenstein

F64 = NDArray[np.float64]

# Share still going forwards below which two bands say as much; beneath it the lobe's difference
# cancels in float32.
_LEAST_KEPT = 0.02


def forward_scatterings(depth: ArrayLike) -> F64:
    """m = u/(1 - exp(-u)), the mean number of scatterings of those who had any.

    `depth` u: g times the optical depth of scattering along the light's way.
    """
    u = np.asarray(depth, dtype=np.float64)
    small = np.abs(u) < 1e-3
    safe = np.where(small, 1.0, u)
    return np.where(small, 1.0 + 0.5 * u, safe / -np.expm1(-safe))


def forward_phase(mu: ArrayLike, g: ArrayLike, scatterings: ArrayLike) -> F64:
    """Phase function, sr^-1, of their next scattering at the cosine `mu` to the light's way.

    (HG(g^(1+m)) - (1 - g^m)/4pi)/g^m, never below 0; mean cosine g. Two bands where
    g^m is below .02.
    """
    m, k, n = np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in (mu, g, scatterings)))
    positive = np.maximum(k, 1e-6)
    kept = positive**n
    safe = np.maximum(kept, _LEAST_KEPT)
    lobe = henyey_greenstein(m, positive * kept)
    forward = (lobe - (1.0 - kept) * ISOTROPIC) / safe
    is_lobe = (k > 0.0) & (kept >= _LEAST_KEPT)
    two_bands = ISOTROPIC * (1.0 + 3.0 * k * m)
    return np.asarray(np.maximum(0.0, np.where(is_lobe, forward, two_bands)))
