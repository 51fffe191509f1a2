"""Directions that a smooth surface mirrors the eye's ray into, chosen by what microfacets it sees.

Twin of `wgsl/ggx_sampling.wgsl`. Vectors are in axes whose third is the surface's normal; `alpha`
is its roughness squared.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64


def visible_normal(v: ArrayLike, alpha: ArrayLike, numbers: ArrayLike) -> F64:
    """Unit normals (..., 3) of microfacets, as often as the eye sees them.

    `v` (..., 3): unit, towards the eye; `numbers` (..., 2) in [0, 1), uniform. Source: Heitz2018b,
    Sampling the GGX distribution of visible normals.
    """
    eye, u = np.asarray(v, dtype=np.float64), np.asarray(numbers, dtype=np.float64)
    a = np.asarray(alpha, dtype=np.float64)[..., None]
    # Where facets are stretched to a hemisphere, it is seen as a disk and a half of one, joined.
    stretched = _unit(np.concatenate([a * eye[..., :2], eye[..., 2:]], axis=-1))
    flat = (stretched[..., :2] ** 2).sum(axis=-1)
    turned = np.stack([-stretched[..., 1], stretched[..., 0], np.zeros_like(flat)], axis=-1)
    along = turned / np.sqrt(np.maximum(flat, 1e-12))[..., None]
    across = np.where((flat > 1e-12)[..., None], along, np.array([1.0, 0.0, 0.0]))
    # A uniform point of the disk, moved into the part that the eye sees (Heitz2018b).
    radius, angle = np.sqrt(u[..., 0]), 2.0 * np.pi * u[..., 1]
    x, s = radius * np.cos(angle), 0.5 * (1.0 + stretched[..., 2])
    y = (1.0 - s) * np.sqrt(np.maximum(1.0 - x * x, 0.0)) + s * radius * np.sin(angle)
    # Up to the hemisphere, and back to facets that are not stretched.
    z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    h = x[..., None] * across + y[..., None] * np.cross(stretched, across)
    h = h + z[..., None] * stretched
    return _unit(np.concatenate([a * h[..., :2], np.maximum(h[..., 2:], 1e-6)], axis=-1))


def mirrored_density(n_h: ArrayLike, n_v: ArrayLike, alpha: ArrayLike) -> F64:
    """The density (...), sr^-1, of directions mirrored at `visible_normal`.

    `n_h`, `n_v`: cosines of the microfacet's normal and of the eye.
    """
    # Smith's masking of the eye alone: facets that it sees are sampled.
    cosine, a2 = np.asarray(n_v, dtype=np.float64), np.asarray(alpha, dtype=np.float64) ** 2
    seen = cosine + np.sqrt(a2 + (1.0 - a2) * cosine**2)
    return np.asarray(_distribution(n_h, a2) / (2.0 * seen))


def mirrored_gloss(n_h: ArrayLike, n_l: ArrayLike, n_v: ArrayLike, alpha: ArrayLike) -> F64:
    """GGX's BRDF without Fresnel's term, times the cosine `n_l` to the light, sr^-1 (...).

    Smith's shadowing is height-correlated (Heitz2014).
    """
    light, eye = np.asarray(n_l, dtype=np.float64), np.asarray(n_v, dtype=np.float64)
    a2 = np.asarray(alpha, dtype=np.float64) ** 2

    # Height-correlated masking and shadowing.
    behind = eye * np.sqrt(light**2 * (1.0 - a2) + a2) + light * np.sqrt(eye**2 * (1.0 - a2) + a2)
    return np.asarray(_distribution(n_h, a2) * 0.5 / np.maximum(behind, 1e-6) * light)


def _distribution(n_h: ArrayLike, a2: F64) -> F64:
    cosine = np.asarray(n_h, dtype=np.float64)
    return np.asarray(a2 / (np.pi * (cosine**2 * (a2 - 1.0) + 1.0) ** 2))


def _unit(v: F64) -> F64:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))
