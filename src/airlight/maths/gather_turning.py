"""Final gather: the light of points, turned to the normals of the pixels between them.

Twin of a part of `wgsl/gather.wgsl`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64

LEAST_COSINE = 0.1
"""Rays that graze more count as if they grazed like this in what turning a normal changes."""
TRUST = 0.1
"""Of gathered irradiance, what is there for whatever normal: light from beyond the horizon."""
MOST_DETAIL = 4.0
"""How many times brighter or darker than its gather points a pixel is at most."""


def flux_along(normal: ArrayLike, direction: ArrayLike) -> F64:
    """What a cosine-distributed ray (..., 3) adds to a point's flux for each unit of its radiance.

    pi times the mean over rays of radiance times this is the vector irradiance of the hemisphere
    over `normal`, whose product with a normal near by is the irradiance there. Its part along
    `normal` is 1: the same normal has the same irradiance. Source: Ward1992 (by rotation).
    """
    n, d = np.asarray(normal, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    cosine = (n * d).sum(axis=-1, keepdims=True)
    return np.asarray(n + (d - cosine * n) / np.maximum(cosine, LEAST_COSINE))


def turn_ratio(flux: ArrayLike, normal: ArrayLike) -> F64:
    """Irradiance on a surface of `normal` (..., 3) over that of the points around.

    `flux` (..., 3): their vector irradiance for each unit of irradiance, 1 along their normal. Of
    light that fills their hemisphere evenly (|flux| = 1) a half follows the normal, which gives
    (1 + cosine) / 2, and of a beam that grazes them nearly all. Source: Ward1992 (by rotation).
    differs: there all of it follows the normal, as of a beam, and broad light is lost: what comes
    from below the points' horizon is not in the flux.
    """
    f, n = np.asarray(flux, dtype=np.float64), np.asarray(normal, dtype=np.float64)
    # Points of several normals have less flux than light: it comes from all around.
    square = np.maximum((f * f).sum(axis=-1), 1e-20)
    follows = np.maximum(1.0 - 0.5 / square, 0.0)
    return np.asarray(np.maximum(1.0 - follows + follows * (f * n).sum(axis=-1), 0.0))


def detailed(gathered: ArrayLike, around: ArrayLike, own: ArrayLike) -> F64:
    """Irradiance of a pixel, W m^-2, from that `gathered` at the points around it.

    `around` and `own`: in the same unit, what the direction of the points' light and near occluders
    make of it for the points and for the pixel.
    """
    # A part of the light does not follow the normal, so that no ratio is without bound.
    light, a, b = (np.asarray(v, dtype=np.float64) for v in (gathered, around, own))
    trust = TRUST * light
    ratio = (b + trust) / np.maximum(a + trust, 1e-20)
    return np.asarray(light * np.clip(ratio, 1.0 / MOST_DETAIL, MOST_DETAIL))
