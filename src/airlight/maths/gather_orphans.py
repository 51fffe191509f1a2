"""Orphans of a final gather: pixels that no gather point is like, and what lights them.

Twin of `wgsl/gather_orphans.wgsl`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .arrays import F64
from .gather import approach

KIN_POWER = 2.0
"""As `gather.NORMAL_POWER`, for points that are not alike and get about the same light."""
KIN_REACH = 0.5
"""As `gather.REACH`, for those."""
KIN_TEXELS = 8.0
"""Widths of a point's texel over which they count, wherever their light comes from."""


def kinship(
    normal: ArrayLike,
    its_normal: ArrayLike,
    offset: ArrayLike,
    squares: ArrayLike,
    products: ArrayLike,
    texel_m: ArrayLike,
) -> F64:
    """How far (...) a point's light stands for a pixel's on another surface, 0 to 1.

    Their unit normals (..., 3), the `offset` (..., 3) between them, m, the point's mean of
    `nearness`, and how wide a texel is there, `texel_m` (...), m. Where no point is like a pixel,
    those around that face about as it does, and are near beside how far off their light comes
    from, still know more of it than lattices.
    """
    n, m = (np.asarray(v, dtype=np.float64) for v in (normal, its_normal))
    cosine = np.clip((n * m).sum(axis=-1), 0.0, 1.0)
    apart = np.square(offset).sum(axis=-1) / np.square(KIN_TEXELS * np.asarray(texel_m))
    near = np.exp(-approach(offset, squares, products) / KIN_REACH**2 - apart)
    return np.asarray(cosine**KIN_POWER * near)


def listed_before(index: ArrayLike, count: int, most: int, phase: int) -> NDArray[np.uint32]:
    """How many (...) of `count` things before number `index` (...) are in a list of `most`.

    All are where they fit; else as many as do, evenly spread, and with another `phase`, from 0 to
    `count` - 1, others. Number k is in the list where the next one has one more before it. Exact in
    u32 arithmetic while `count` times `most` is.
    """
    k = np.asarray(index, dtype=np.uint32)
    spread = (k * np.uint32(most) + np.uint32(phase)) // np.uint32(max(count, 1))
    return np.asarray(spread if count > most else k, dtype=np.uint32)


def orphan_step(side: int) -> int:
    """Pixels of a square of `side` x `side` from one that is looked at to the next, row by row.

    All are met once, and those in a row lie far apart: near the golden section of their number, and
    one more than a multiple of the side, so that they have no divisor in common.
    """
    return side * round(0.381966 * side) + 1
