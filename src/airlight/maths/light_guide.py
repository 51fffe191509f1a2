"""Rays towards what lights shine on: directions within cones, and how many rays go there.

Twin of `wgsl/guided_share.wgsl`. What a ray counts, whichever way its direction was chosen, is
`maths.gather.sky_share`: the same balance heuristic (Veach1995).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .sampling import orthonormal_frame

F64 = NDArray[np.float64]

PATCHES = 16
"""Spheres around all that lights shine on."""
RARE = 0.03
"""Share of cosine-distributed rays that find lit patches at which half as many are guided."""
COMMON = 0.25
"""The share from which on none are."""
MOST_GUIDED = 0.5
"""Of the rays of later segments, where the patches are as small as can be."""


def cone_direction(axis: ArrayLike, height: ArrayLike, numbers: ArrayLike) -> F64:
    """Unit directions (..., 3), even over a cone about the unit `axis` (..., 3).

    `height` (...): one minus the cosine of half its angle; `numbers` (..., 2) in [0, 1), uniform.
    The cone has 2 pi `height` steradians.
    """
    n, u = np.asarray(axis, dtype=np.float64), np.asarray(numbers, dtype=np.float64)

    # Equal steps of the height are equal areas of the sphere.
    drop, angle = u[..., 0] * np.asarray(height), 2.0 * np.pi * u[..., 1]
    radius = np.sqrt(np.maximum(drop * (2.0 - drop), 0.0))
    tangent, bitangent = orthonormal_frame(n)
    x, y, z = radius * np.cos(angle), radius * np.sin(angle), 1.0 - drop
    return np.asarray(x[..., None] * tangent + y[..., None] * bitangent + z[..., None] * n)


def guided_share(found: ArrayLike) -> F64:
    """Which part (...) of the rays of later segments is guided to what lights shine on.

    `found`: the share of cosine-distributed rays that would find it by themselves.
    """
    f = np.asarray(found, dtype=np.float64)
    return np.asarray(np.where(f < COMMON, MOST_GUIDED / (1.0 + f / RARE), 0.0))
