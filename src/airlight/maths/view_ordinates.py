"""Ordinates by a map's light and its importance to a camera: product sampling (Elek2014, 5.2).

The parts of `ordinates.partition`, attracted by importance. They overlap a little (fuzzy c-means)
and start from centres of the map alone, so that they move as smoothly as the camera and need no
memory of earlier frames.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .arrays import F64
from .colour import luminance
from .latlong import latlong_row_solid_angles
from .ordinates import ROUNDS, Ordinates, importance_sampled, map_texels, seeds, unit_rows

UNSEEN = 0.3  # weight of what no pixel sees, where the mean weight of importance is 1
_CRISP = 8.0  # exponent of a centre's squared distance: parts overlap over a tenth of their size


def view_partition(radiance: ArrayLike, count: int, importance: F64) -> Ordinates:
    """`count` ordinates of a map (H, W, 3), W m^-2 sr^-1; `importance` (h, w) is a coarser map.

    Light is kept as `ordinates.partition` keeps it.
    """
    # Texels that the view sees pull their ordinates nearer.
    power, weight, towards, solid_angle = map_texels(np.asarray(radiance, dtype=np.float64))
    centre = seeds(weight, count)
    seen = resized(importance, weight.shape)
    pull = (weight * (UNSEEN + seen)).reshape(-1, 1)
    flat = towards.reshape(-1, 3)
    unit = unit_rows(flat, flat)
    # Centres move to the weighted mean of their texels, which near centres share.
    for _ in range(ROUNDS):
        centre = unit_rows(_shares(unit, centre).T @ (pull * unit), centre)
    # Each ordinate carries its texels' power, along their mean, as sharp as they lie together.
    share = _shares(unit, centre).T
    light = luminance(power).reshape(-1, 1)
    carried, vector = share @ light[:, 0], share @ (light * flat)
    cosine = np.linalg.norm(vector, axis=1) / np.maximum(carried, 1e-300)
    omega = share @ solid_angle.ravel()
    cosine = np.where(carried > 0.0, np.minimum(cosine, 1.0), 1.0 - omega / (4.0 * np.pi))
    return Ordinates(-unit_rows(vector, centre), share @ power.reshape(-1, 3), omega, cosine)


def view_samples(radiance: ArrayLike, count: int, importance: F64) -> Ordinates:
    """`ordinates.importance_sampled` of a map's product with `importance`, as the paper does."""
    rgb = np.asarray(radiance, dtype=np.float64)
    return importance_sampled(rgb, count, UNSEEN + resized(importance, rgb.shape[:2]))


def resized(importance: F64, shape: tuple[int, ...]) -> F64:
    """A latitude-longitude map (h, w) at another size, bilinear, mean 1 over the sphere."""
    # Where each row and column of the new size lies in the old one.
    rows, columns = importance.shape
    height, width = shape
    v = np.clip((np.arange(height) + 0.5) / height * rows - 0.5, 0.0, rows - 1.0)
    u = (np.arange(width) + 0.5) / width * columns - 0.5
    top, left = np.floor(v).astype(np.int64), np.floor(u).astype(np.int64)
    down, across = (v - top)[:, None], u - left
    # Longitudes go on around the sphere; latitudes end at the poles.
    between = (1.0 - down) * importance[top] + down * importance[np.minimum(top + 1, rows - 1)]
    seen = (1.0 - across) * between[:, left % columns] + across * between[:, (left + 1) % columns]
    omega = latlong_row_solid_angles(height, width)[:, None]
    return np.asarray(seen * 4.0 * np.pi / max(float((seen * omega).sum()), 1e-300))


def _shares(unit: F64, centre: F64) -> F64:
    """(texel, centre): what each centre has of each texel, 1 altogether."""
    # Powers of the distances' ratio, by the nearest one so that none overflows.
    away = np.log(np.maximum(1.0 - unit @ centre.T, 1e-9))
    near = np.exp(_CRISP * (away.min(axis=1, keepdims=True) - away))
    return np.asarray(near / near.sum(axis=1, keepdims=True))
