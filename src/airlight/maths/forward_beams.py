"""Light that media only scatter forwards: their reduced media transmit it, they do not.

For any media on a light's path: a lattice's, and volumes that are
solved on grids of their own. Their depths add up. In the reduced medium (similarity theory, see
`media.reduced`) the share g of what is scattered counts as unscattered.
Source: ours; see `scatter.forward`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64

SPREAD, BACK = 0.41, 0.58
"""Root mean squares over a path in a medium that deflects alike everywhere, of its length: across
it, over sqrt(2 (1 - g)), 1/sqrt(6); and how far back light is deflected, 1/sqrt(3)."""
INSIDE = 0.8
"""Of the sides of a medium's box: where light comes from to paths that pass the medium by."""


def depths(columns: ArrayLike, sigma_t: ArrayLike, albedo: ArrayLike, g: ArrayLike) -> F64:
    """(reduced, forward), each (..., channel): optical depths of all media on a path.

    `columns` (..., media), m, of density; `sigma_t`, `albedo`, `g` (media, channel). `forward` is
    the depth that the media have beside the reduced ones.
    """
    # Of scattered light the share g counts as unscattered in the reduced medium.
    c, scattered = np.asarray(columns, np.float64), np.multiply(sigma_t, albedo)
    forward = scattered * np.asarray(g)
    return np.stack([c @ (np.asarray(sigma_t) - forward), c @ forward])


def passed_forwards(reduced: ArrayLike, forward: ArrayLike) -> F64:
    """T' - T, the share of a light's irradiance that arrives scattered forwards alone."""
    r, f = np.asarray(reduced, np.float64), np.asarray(forward, np.float64)
    return np.asarray(np.exp(-r) * -np.expm1(-f))


def slant(near: ArrayLike, far: ArrayLike, g: ArrayLike) -> tuple[F64, F64]:
    """(deviation, back), m, of light that a medium deflects between `near` and `far`, m, before a
    point: across its direction, and how far back it is deflected.
    """
    a, b = np.asarray(near, np.float64), np.asarray(far, np.float64)
    # Three times the mean square of the distance from the point.
    reach = np.sqrt(a * a + a * b + b * b)
    return SPREAD * np.sqrt(2.0 * (1.0 - np.asarray(g))) * reach, BACK * reach


def span_beside(size: ArrayLike, origin: ArrayLike, towards: ArrayLike) -> F64:
    """(..., 3) near, far, aside, m: where a box about 0 lies on a parallel of a path.

    The path begins at `origin` (..., 3) and goes `towards` (..., 3), unit length; the parallel
    goes through the nearest point of a box of INSIDE the sides of `size` (3,), m, and lies `aside`
    of it. `near` is above `far` where the box lies behind.
    """
    o, d = np.asarray(origin, np.float64), np.asarray(towards, np.float64)
    half = 0.5 * np.asarray(size, np.float64)
    # The nearest points of box and path, each projected onto the other a few times.
    t = np.maximum(-(o * d).sum(axis=-1), 0.0)
    nearest = np.zeros(o.shape)
    for _ in range(3):
        nearest = np.clip(o + t[..., None] * d, -INSIDE * half, INSIDE * half)
        t = np.maximum(((nearest - o) * d).sum(axis=-1), 0.0)
    # The parallel through that point is the path moved across itself.
    offset = nearest - (o + t[..., None] * d)
    aside = offset - (offset * d).sum(axis=-1, keepdims=True) * d
    # Where it enters and leaves the box, slab by slab.
    with np.errstate(divide="ignore"):
        ends = np.sort([(-half - o - aside) / d, (half - o - aside) / d], axis=0)
    near, far = ends[0].max(axis=-1), ends[1].min(axis=-1)
    return np.stack([np.maximum(near, 0.0), far, np.linalg.norm(aside, axis=-1)], axis=-1)
