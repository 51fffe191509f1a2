"""Layers of a medium as two streams see them: what they reflect and transmit.

Light that collides is absorbed, or scattered to both sides alike, where it may collide again.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64

ALONG_HOPS = 0.8
"""What light's path is of a hop along an axis, for absorption: straight paths have .69 of the steps
along axes that lead to the same place, in the mean over directions; light in lattices wanders."""


def layer(depth: ArrayLike, albedo: ArrayLike) -> tuple[F64, F64]:
    """(reflected, transmitted), the shares of the light that meets a layer of optical `depth`.

    F' = -(1 - a/2) F + a/2 B of the stream F, and the same of B the other way, have the solution
    R = a/2 s/n, T = 2 e/n with k = sqrt(1 - a), e = exp(-k x), s = (1 - e^2)/k (2 x without
    absorption) and n = 1 + e^2 + (1 - a/2) s. Source: Schuster1905.
    """
    x, a = np.asarray(depth, np.float64), np.asarray(albedo, np.float64)
    decay = np.sqrt(1.0 - a)
    far = np.exp(-decay * x)
    # s by its limit where nothing decays.
    twice = 2.0 * decay * x
    safe = np.where(twice < 1e-6, 1.0, twice)
    rise = 2.0 * x * np.where(twice < 1e-6, 1.0 - 0.5 * twice, -np.expm1(-safe) / safe)
    lost = 1.0 + far * far + (1.0 - 0.5 * a) * rise
    return np.asarray(0.5 * a * rise / lost), np.asarray(2.0 * far / lost)


def columns(depths: ArrayLike, albedo: ArrayLike) -> tuple[F64, F64]:
    """The same of layers side by side, `depths` (..., column): each has as much light."""
    reflected, transmitted = layer(depths, np.asarray(albedo, np.float64)[..., None])
    return np.asarray(reflected.mean(axis=-1)), np.asarray(transmitted.mean(axis=-1))
