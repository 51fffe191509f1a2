"""Coarser lattices that hurry slow light along: grids of 2, 4, ... cells a side, in NumPy.

With M one iteration and I the injected state, the sum of all states obeys Q = I + M Q. Stepping
Q converges by one hop an iteration; what is missing, r = I + M Q - Q, can be solved for on a
lattice of half the resolution, whose hops are twice as long, and added (multigrid, Brandt1977).
Source: ours; the coarse deposit keeps the fine walk's diffusion.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .lattice26 import hops
from .medium import mean_absorption_depth, mean_transmittance

F64 = NDArray[np.float64]
_LIMIT_BELOW = 1e-3


def coarse_absorption_depth(x: ArrayLike, level: int) -> F64:
    """Where in [0, 1] a hop of optical depth `x` on coarse level `level` deposits its light.

    Level 0 is the physical place, mean_absorption_depth. A coarse walk takes longer hops between
    deposits; this place gives it the mean squared path of the 2^level times finer walk.
    """
    depth = np.asarray(x, dtype=np.float64)
    if level == 0:
        return mean_absorption_depth(depth)
    small = depth < _LIMIT_BELOW
    safe = np.where(small, 1.0, np.minimum(depth, 600.0))
    # The hops before a loss are geometrically distributed: their mean and mean square.
    j1 = 1.0 / np.expm1(safe)
    j2 = j1 * (2.0 * j1 + 1.0)
    # The squared path j2 + m (2 j1 + 1), m deposited ahead, equals that of the finer walk.
    matched = (_squared_path(safe / 2.0**level) / 4.0**level - j2) / (2.0 * j1 + 1.0)
    return np.where(small, 0.5, np.clip(matched, 0.0, 1.0))


def _squared_path(x: F64) -> F64:
    """Mean squared number of hops of depth `x` between scatterings, deposited linearly."""
    # Geometrically distributed hops, the last of them in part.
    j1 = 1.0 / np.expm1(x)
    return np.asarray((2.0 * j1 + 1.0) * (j1 + mean_absorption_depth(x)))


def mean_track(sigma_t: ArrayLike, cell_size_m: float) -> F64:
    """Track length, m, of isotropic light per hop in extinction `sigma_t` (...), m^-1."""
    # Each hop's length by its mean transmittance, weighted by the power it takes.
    table, sigma = hops(), np.asarray(sigma_t, dtype=np.float64)
    lengths = cell_size_m * table.lengths
    return np.asarray((lengths * mean_transmittance(sigma[..., None] * lengths)) @ table.weights)


def restricted(cells: ArrayLike, *, is_mean: bool = False) -> F64:
    """Sums (or means) over 2 x 2 x 2 cells of (C, Z, Y, X, ...); odd sides end in part cells."""
    # Odd sides are filled up with empty cells.
    fine = np.asarray(cells, dtype=np.float64)
    weight = np.ones(fine.shape[1:4])
    pads = [(0, n % 2) for n in fine.shape[1:4]]
    fine = np.pad(fine, [(0, 0), *pads, *[(0, 0)] * (fine.ndim - 4)])
    total = _pair_sums(fine)
    if not is_mean:
        return total
    # At odd ends cells are in part outside: means are over what is inside.
    count = _pair_sums(np.pad(weight, pads)[None])[0]
    return np.asarray(total / count.reshape(count.shape + (1,) * (fine.ndim - 4)))


def _pair_sums(cells: F64) -> F64:
    c, z, y, x = cells.shape[:4]
    blocks = cells.reshape(c, z // 2, 2, y // 2, 2, x // 2, 2, *cells.shape[4:])
    return np.asarray(blocks.sum(axis=(2, 4, 6)))


def restricted_faces(faces: ArrayLike) -> F64:
    """Open shares (6, Z, Y, X) of incoming face hops, on the coarse lattice.

    Walls on a coarse face count by area. Those inside a coarse cell count whole on both faces that
    they lie between: a correction may be too small, but is never handed through a wall, as it
    would be through two half-open faces.
    """
    shut = 1.0 - np.asarray(faces, dtype=np.float64)
    coarse = []
    for index in range(6):
        axis, is_low = 2 - index // 2, index % 2 == 0
        # Hop + enters through the low face, hop - through the high one: planes by their low side.
        on_plane = shut[index] if is_low else _moved(shut[index], axis, 1)
        joined = on_plane + _moved(on_plane, axis, 1) + _moved(on_plane, axis, -1)
        area = _means_across(joined, axis)
        even = np.take(area, np.arange(0, area.shape[axis], 2), axis=axis)
        if not is_low:
            even = _moved(even, axis, -1)
        coarse.append(1.0 - np.clip(even, 0.0, 1.0))
    return np.array(coarse)


def _moved(cells: F64, axis: int, step: int) -> F64:
    """Values moved by `step` along `axis`, zeros coming in."""
    # What leaves at one end is lost.
    moved = np.zeros_like(cells)
    target: list[slice] = [slice(None)] * 3
    source: list[slice] = [slice(None)] * 3
    target[axis] = slice(step, None) if step > 0 else slice(None, step)
    source[axis] = slice(None, -step) if step > 0 else slice(-step, None)
    moved[tuple(target)] = cells[tuple(source)]
    return moved


def _means_across(cells: F64, axis: int) -> F64:
    """Means over pairs along the two axes other than `axis`; part pairs over what is there."""
    # One axis after the other; an odd end stands for its pair.
    mean = cells
    for other in (a for a in range(3) if a != axis):
        first = np.take(mean, np.arange(0, mean.shape[other], 2), axis=other)
        last = np.minimum(np.arange(0, mean.shape[other], 2) + 1, mean.shape[other] - 1)
        mean = 0.5 * (first + np.take(mean, last, axis=other))
    return np.asarray(mean)


def prolonged(coarse: ArrayLike, shape: tuple[int, int, int]) -> F64:
    """Each coarse cell's (C, Z, Y, X, ...) value in its fine cells, cut to `shape` (Z, Y, X)."""
    fine = np.asarray(coarse, dtype=np.float64)
    for axis, count in zip((1, 2, 3), shape, strict=True):
        fine = np.take(np.repeat(fine, 2, axis=axis), np.arange(count), axis=axis)
    return fine
