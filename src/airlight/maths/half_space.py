"""Light in a homogeneous half-space that parallel light enters from above.

What a lattice cannot hold of a medium without an end: far from everything, light depends on the
depth alone. Scattering counts as isotropic; coefficients of media that scatter forwards are scaled
by similarity before (`media.reduced`).
Source: the integral equation of Schwarzschild and Milne (Chandrasekhar1950).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .arrays import F64

# Optical depths. What goes deeper where nothing is absorbed comes back: the last is a mirror.
_EDGES = np.concatenate([[0.0], np.geomspace(0.02, 40.0, 64)])


@dataclass(frozen=True)
class PlaneLight:
    """At optical depths (N,) below the top: `scattered` fluence (N,) of light that was scattered
    at least once, its net `flux` downwards (N,) and what of it comes from above, `down` (N,);
    W m^-2. `sent` (M,): what layers of the medium scatter, per optical depth.
    """

    depth: F64
    scattered: F64
    flux: F64
    down: F64
    sent: F64


def plane_light(albedo: float, cosines: F64, irradiances: F64) -> PlaneLight:
    """One channel. `cosines` (B,) of beams to the vertical, `irradiances` (B,) across them.

    Beams that do not come from above bring nothing.
    """
    k = _kernels()
    is_down = cosines > 1e-3
    mu, e = cosines[is_down], irradiances[is_down]
    # Of each layer, the mean of what beams bring.
    passed = np.exp(-_EDGES[:, None] / mu)
    beams = ((passed[:-1] - passed[1:]) * mu * e).sum(axis=1) / np.diff(_EDGES)
    # Each layer sends its albedo times what beams and all layers bring: a linear system.
    sent = np.linalg.solve(np.eye(len(beams)) - albedo * k.between, albedo * beams)
    down, up = k.down @ sent, k.up @ sent
    return PlaneLight(k.depth, k.fluence @ sent, down - up, down, sent)


def plane_radiance(light: PlaneLight, depth: F64, cosines: F64) -> F64:
    """(N, K), W m^-2 sr^-1: what an eye at optical `depth` (N,) sees of `light` that was scattered
    at least once, where it looks up by `cosines` (K,), not 0, to the vertical.
    """
    d, mu = depth[:, None, None], cosines[None, :, None]
    # To each layer's borders, as far as they lie ahead.
    ahead = np.maximum((d - _EDGES) * np.sign(mu), 0.0)
    seen = np.abs(np.diff(np.exp(-ahead / np.abs(mu)), axis=2))
    deep = 2.0 * _EDGES[-1] - d  # what the mirror at the end shows of what lies before it
    mirrored = np.abs(np.diff(np.exp(-np.maximum(deep - _EDGES, 0.0) / np.abs(mu)), axis=2))
    return np.asarray((seen + np.where(mu < 0.0, mirrored, 0.0)) @ light.sent / (4.0 * np.pi))


@dataclass(frozen=True)
class _Kernels:
    """What layers of unit emission (4 pi J = 1 per depth) send: `between` their middles (M, M), and
    to `depth` (N,) as in PlaneLight, each (N, M).
    """

    between: F64
    depth: F64
    fluence: F64
    down: F64
    up: F64


@lru_cache(maxsize=1)
def _kernels() -> _Kernels:
    # Layers' middles, and the top itself.
    middles = 0.5 * (_EDGES[1:] + _EDGES[:-1])
    depth = np.concatenate([[0.0], middles])

    # The mirror at the deepest edge shows every layer once more.
    mirrored = 2.0 * _EDGES[-1] - depth
    fluence = _fluence(depth) + _fluence(mirrored)
    up = _up(depth) + _down(mirrored)
    return _Kernels(fluence[1:], depth, fluence, _down(depth), up)


def _fluence(at: F64) -> F64:
    # The integral of E1 over each layer, by E2 at its borders; one around the point has two parts.
    low, high = np.abs(at[:, None] - _EDGES[:-1]), np.abs(at[:, None] - _EDGES[1:])
    is_inside = (at[:, None] > _EDGES[:-1]) & (at[:, None] < _EDGES[1:])
    near, far = _exponential_integral(2, low), _exponential_integral(2, high)
    return 0.5 * np.where(is_inside, 2.0 - near - far, np.abs(near - far))


def _down(at: F64) -> F64:
    # Layers above send down, by E3 of the depths of their two borders.
    above = np.maximum(at[:, None] - _EDGES, 0.0)
    return 0.5 * np.diff(_exponential_integral(3, above), axis=1)


def _up(at: F64) -> F64:
    # Layers below send up.
    below = np.maximum(_EDGES - at[:, None], 0.0)
    return -0.5 * np.diff(_exponential_integral(3, below), axis=1)


def _exponential_integral(order: int, x: F64) -> F64:
    """E_n(x) = integral of mu^(n-2) exp(-x/mu) over 0..1, for n = 2 and 3; to 1e-6."""
    # Gauss-Legendre in the cube root of the cosine.
    nodes, weights = np.polynomial.legendre.leggauss(48)
    t, w = 0.5 * (nodes + 1.0), 0.5 * weights
    mu = t**3  # many nodes where exp(-x/mu) turns at small x
    return np.asarray(np.exp(-x[..., None] / mu) @ (w * 3.0 * t**2 * mu ** (order - 2)))
