"""Light of cells on cells half as wide.

Each takes a cubic spline through the 64 cells around it (of Catmull and Rom: Barry1988). It follows
the curve of light that falls off exponentially, of which trilinear interpolation takes chords, and
chords of a convex curve lie above it. Cells that hold no light do not count, and no value leaves
the range of the eight cells around it.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LEAST_TOTAL = 0.1
"""Weights of cells without light are missing; the rest counts as at least so much."""


def halved_cells(values: ArrayLike, known: ArrayLike) -> NDArray[np.float64]:
    """(2z, 2y, 2x, c) <- `values` (z, y, x, c) of the cells that are `known` (z, y, x).

    0 within cells that are not.
    """
    light, known = np.asarray(values, np.float64), np.asarray(known, bool)
    shape = np.array(known.shape)
    made = np.zeros((*(2 * shape), light.shape[-1]))
    for fine in product(*(range(2 * n) for n in shape)):
        if known[tuple(i // 2 for i in fine)]:
            made[fine] = _at(light, known, np.array(fine))
    return made


def spline_weights(t: float) -> NDArray[np.float64]:
    """Of four neighbours in a row, at `t`, 0 to 1, between the second and the third."""
    s = 1.0 - t
    middle = (2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)))
    return 0.5 * np.array([-t * s * s, *middle, -t * t * s])


def _at(light: NDArray[Any], known: NDArray[Any], fine: NDArray[Any]) -> NDArray[np.float64]:
    at = 0.5 * fine - 0.25
    base = np.floor(at).astype(int)
    weights = [spline_weights(float(t)) for t in at - base]
    total, sums = 0.0, np.zeros(light.shape[-1])
    around = []
    for corner in product(range(4), repeat=3):
        cell = tuple(np.clip(base - 1 + corner, 0, np.array(known.shape) - 1))
        if not known[cell]:
            continue
        weight = float(np.prod([w[c] for w, c in zip(weights, corner, strict=True)]))
        sums, total = sums + weight * light[cell], total + weight
        if set(corner) <= {1, 2}:
            around.append(light[cell])
    low, high = np.min(around, axis=0), np.max(around, axis=0)
    return np.asarray(np.clip(sums / max(total, LEAST_TOTAL), low, high))
