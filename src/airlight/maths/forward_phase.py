"""The phase function of light with at most one deflection on its path to the eye, of all orders.

By similarity, scattering of mean cosine g goes straight on in a share g of all events and is
isotropic in the others (`media.reduced`). A lattice holds light with two isotropic events or more.
Light with one or none is deflected at about one point: scattered k times it has there the phase
function of Henyey and Greenstein with g^k, less what the lattice has of that order.
Source: ours (measured against Monte Carlo).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .phase import ISOTROPIC, henyey_greenstein

COSINES, DEPTHS = 64, 32
"""Of a table: columns, dense towards where light goes, and rows."""
_DEEPEST = 40.0
_STRAYED = 0.06  # per square of similar depth: what no longer is near its beam; fitted to cubes


def fused_phase(mu: ArrayLike, g: float, depth: ArrayLike) -> F64:
    """sr^-1, of light scattered twice or more, at cosines `mu` between its path and the eye's.

    `depth`: optical depth of scattering, u, on both of its paths. Times sigma_s, the light's
    irradiance and the transmittance of the reduced medium on both paths, exp((g - 1) u), it is
    emission:
    exp(-g u) sum over k >= 2 of u^(k-1)/k! (HG(g^k) - (1 - g^k - k g^(k-1) (1 - g))/4pi),
    times exp(-.06 ((1 - g) u)^2), since deep in thick media paths are not straight.
    """
    # The sum over orders of scattering ends where their share vanishes.
    m, u = np.broadcast_arrays(np.asarray(mu, np.float64), np.asarray(depth, np.float64))
    total = np.zeros(m.shape)
    # exp(-g u) u^(k-1)/k! from k = 2 on, each term from the one before.
    share = 0.5 * u * np.exp(-g * u)
    for k in range(2, _orders(u)):
        held = 1.0 - g**k - k * g ** (k - 1) * (1.0 - g)
        total += share * (henyey_greenstein(m, g**k) - held * ISOTROPIC)
        share = share * u / (k + 1)
    return total * np.exp(-_STRAYED * np.square((1.0 - g) * u))


def _orders(depth: F64) -> int:
    # The mean and eight deviations of a Poisson distribution.
    largest = float(np.max(depth, initial=0.0))
    return 16 + int(largest + 8.0 * math.sqrt(largest))


def fused_table(g: float) -> F64:
    """(DEPTHS, COSINES) of fused_phase: rows at u/(1 + u), columns at ((1 - mu)/2)^(1/4), both in
    equal steps; the last row is 40 optical depths.
    """
    # Equal steps of the table's own coordinates; depths end where little light is left.
    t = np.linspace(0.0, 1.0, COSINES)
    share = np.linspace(0.0, _DEEPEST / (1.0 + _DEEPEST), DEPTHS)
    if g <= 0.0:  # no light goes straight on
        return np.zeros((DEPTHS, COSINES))
    mu, depth = 1.0 - 2.0 * t**4, (share / (1.0 - share))[:, None]
    return fused_phase(mu, g, depth)
