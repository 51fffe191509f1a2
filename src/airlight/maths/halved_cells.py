"""Light of cells on cells half as wide.

Each takes a cubic spline through the 64 cells around it (of Catmull and Rom: Barry1988). It follows
the curve of light that falls off exponentially, of which trilinear interpolation takes chords, and
chords of a convex curve lie above it. Cells that hold no light do not count, and no value leaves
the range of the eight cells around it. Near surfaces it is trilinear, between cells on one side.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LEAST_TOTAL = 0.1
"""Weights of cells without light are missing; the rest counts as at least so much."""


def halved_cells(
    values: ArrayLike, known: ArrayLike, walls: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """(2z, 2y, 2x, c) <- `values` (z, y, x, c) of the cells that are `known` (z, y, x).

    0 within cells that are not. `walls` (3, z, y, x): how far, in cells, the first surface on the
    path to the next cell along x, y and z is behind a cell's middle; infinite where there is none.
    """
    light, known = np.asarray(values, np.float64), np.asarray(known, bool)
    shape = np.array(known.shape)
    made = np.zeros((*(2 * shape), light.shape[-1]))
    for fine in product(*(range(2 * n) for n in shape)):
        inside = np.array(fine) // 2
        if not known[tuple(inside)]:
            continue
        # Surfaces decide only where one is near; elsewhere the spline is smooth.
        around = tuple(slice(max(i - _NEAR, 0), i + _NEAR + 1) for i in inside)
        if walls is not None and np.isfinite(walls[(slice(None), *around)]).any():
            made[fine] = _walled(light, known, np.array(fine), walls)
        else:
            made[fine] = _at(light, known, np.array(fine))
    return made


_NEAR = 2  # cells


def _walled(
    light: NDArray[Any], known: NDArray[Any], fine: NDArray[Any], walls: NDArray[Any]
) -> NDArray[np.float64]:
    """Of those of the eight cells around that lie on the same side of all surfaces."""
    # The cell on whose side the half cell lies.
    inside, home = fine // 2, fine // 2
    for axis in range(3):
        row, side = 2 - axis, int(fine[2 - axis] & 1)
        below = inside - (np.arange(3) == row) * (1 - side)
        wall = walls[(axis, *below)] if below[row] >= 0 else np.inf
        if np.isfinite(wall) and (wall < 0.25 if side else wall > 0.75):
            home[row] += 1 if side else -1
    # Trilinear weights of the cells that no surface keeps from it.
    at = 0.5 * fine - 0.25
    first = np.floor(at).astype(int)
    total, sums = 0.0, np.zeros(light.shape[-1])
    for corner in product(range(2), repeat=3):
        cell = np.clip(first + corner, 0, np.array(known.shape) - 1)
        is_open = any(_is_open(home, cell, axes, walls) for axes in ((0, 1, 2), (2, 1, 0)))
        if known[tuple(cell)] and is_open:
            weight = max(float(np.where(corner, at - first, 1.0 - at + first).prod()), 1e-4)
            sums, total = sums + weight * light[tuple(cell)], total + weight
    return np.asarray(sums / max(total, 1e-4))


def _is_open(
    begin: NDArray[Any], end: NDArray[Any], axes: tuple[int, ...], walls: NDArray[Any]
) -> bool:
    """Whether no surface stands on the path along one axis after the other."""
    # Step by step along the axes in this order; the first surface on the path closes it.
    at = begin.copy()
    for axis in axes:
        row = 2 - axis
        if at[row] != end[row]:
            below = np.minimum(at, at + (np.arange(3) == row) * (end - at))
            if np.isfinite(walls[(axis, *below)]):
                return False
            at[row] = end[row]
    return True


def spline_weights(t: float) -> NDArray[np.float64]:
    """Of four neighbours in a row, at `t`, 0 to 1, between the second and the third."""
    # Catmull and Rom's weights, which add up to 1.
    s = 1.0 - t
    middle = (2.0 + t * t * (3.0 * t - 5.0), t * (1.0 + t * (4.0 - 3.0 * t)))
    return 0.5 * np.array([-t * s * s, *middle, -t * t * s])


def _at(light: NDArray[Any], known: NDArray[Any], fine: NDArray[Any]) -> NDArray[np.float64]:
    # The middle of the half cell, between the middles of whole ones.
    at = 0.5 * fine - 0.25
    base = np.floor(at).astype(int)
    # A Catmull-Rom spline of 4 x 4 x 4 cells, over the weights of those that are known.
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
    # Never beyond the eight nearest ones: no overshoot at the rim of a shadow.
    low, high = np.min(around, axis=0), np.max(around, axis=0)
    return np.asarray(np.clip(sums / max(total, LEAST_TOTAL), low, high))
