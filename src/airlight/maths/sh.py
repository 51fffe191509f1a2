"""Two-band intensities of lattices: spherical harmonics of bands 0 and 1 as I(w) = a + b.w.

A state (a, bx, by, bz) is in W/sr: a is the mean intensity, b points where most of it goes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64


def cosine_lobe(normal: ArrayLike, power_w: ArrayLike) -> F64:
    """(a, bx, by, bz) of a clamped cosine lobe of total power `power_w` about unit normals.

    Shapes (..., 3) and (...) to (..., 4). a = P/4pi, b = P n/2pi: its two-band projection.
    Source: Kaplanyan2010 section 3.1.
    """
    n, p = np.asarray(normal, dtype=np.float64), np.asarray(power_w, dtype=np.float64)
    a = np.broadcast_to(p / (4.0 * np.pi), n.shape[:-1])
    return np.concatenate([a[..., None], p[..., None] * n / (2.0 * np.pi)], axis=-1)


def intensity(state: ArrayLike, direction: ArrayLike) -> F64:
    """I(w) = a + b.w, W/sr, of (..., 4) states at directions (..., 3); not clamped."""
    s, d = np.asarray(state, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    return np.asarray(s[..., 0] + np.einsum("...i,...i->...", s[..., 1:], d))
