"""Rays towards what lights shine on: directions within cones, and how many rays go there.

Twin of `wgsl/guided_share.wgsl`, `wgsl/light_guide.wgsl` and `wgsl/guide_air.wgsl`. What a ray
counts, however its direction was chosen, is `maths.gather.sky_share`: the same balance heuristic
(Veach1995).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .gather import lobe_density
from .sampling import orthonormal_frame

PATCHES = 16
"""Spheres around all that lights shine on."""
RARE = 0.03
"""Share of cosine-distributed rays that find a lit patch at which it is chosen half as often."""
COMMON = 0.25
"""The share that finds any of them, on average over an image, from which on no ray is guided."""
HALVING = 0.3
"""Such a share at which half as many rays in the air and of later segments are guided."""
MOST_GUIDED = 0.5
"""Of rays in the air and of later segments, where the patches are as small as can be."""
_LEAST_SINE2 = 1e-6
_MOST_SINE2 = 0.9  # a point inside of a sphere, or nearly, finds what is in it by the cosine


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
    """Which part (...) of rays in the air and of later segments is guided to what lights shine on.

    `found`: the share of all other rays that would find it by themselves.
    """
    f = np.asarray(found, dtype=np.float64)
    return np.asarray(MOST_GUIDED / (1.0 + f / HALVING))


def guide_density(
    patches: ArrayLike,
    place: ArrayLike,
    normal: ArrayLike,
    directions: ArrayLike,
    *,
    mean_cosine: float | None = None,
) -> tuple[F64, float]:
    """Density (...) in sr^-1 at which guided rays take unit `directions` (..., 3), and `found`.

    `patches` (K, 8): spheres with centre and radius in metres, the mean normal of what is lit in
    them, and the power in watts that it reflects. `place` (3,) metres, with unit `normal` (3,).
    `found` is the share of other rays that find the patches' light: of patch k they find a share
    f_k and leave noise of l_k^2 / f_k, where l_k is its light. They are distributed by the cosine,
    or from a point in the air by `maths.gather.lobe_density` of this `mean_cosine` about `normal`.
    """
    lit, at, n = (np.asarray(x, dtype=np.float64) for x in (patches, place, normal))

    # Each patch as the point sees it: a cone, about the light that comes from it, its weight.
    to_patch = lit[:, :3] - at
    squared_distance = np.maximum((to_patch**2).sum(axis=1), 1e-20)
    along = to_patch / np.sqrt(squared_distance)[:, None]
    sine2 = lit[:, 3] ** 2 / squared_distance + _LEAST_SINE2
    height = sine2 / (1.0 + np.sqrt(np.maximum(1.0 - sine2, 0.0)))
    sine = np.sqrt(sine2)
    cosine = np.clip((along @ n + sine) / (1.0 + sine), 0.0, 1.0)
    if mean_cosine is not None:
        cosine = np.pi * lobe_density(along @ n, mean_cosine)
    mean_normal = lit[:, 4:7]
    sent = 1.0 - np.linalg.norm(mean_normal, axis=1) + sine - (mean_normal * along).sum(axis=1)
    light = lit[:, 7] * cosine * np.clip(sent, 0.0, 1.0) / squared_distance
    light = np.where(sine2 < _MOST_SINE2, light, 0.0)
    found = np.clip(2.0 * height * cosine, 1e-7, 1.0)
    weight = light / (1.0 + found / RARE)

    # A cone is chosen by its weight, a direction within it evenly; cones overlap.
    cosines = np.asarray(directions, dtype=np.float64) @ along.T
    is_inside = (1.0 - cosines**2 < sine2) & (cosines > 0.0)
    density = (is_inside * weight / (2.0 * np.pi * height)).sum(axis=-1)
    noise = float((light**2 / found).sum())
    share = float(light.sum() ** 2 / noise) if noise > 0.0 else 1.0
    return np.asarray(density / max(float(weight.sum()), 1e-30)), share
