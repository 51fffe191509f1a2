"""Tileable fractal noise in any number of dimensions."""

from __future__ import annotations

from math import prod
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..checks import F32


def fractal_noise(
    shape: tuple[int, ...],
    cells: tuple[int, ...],
    rng: np.random.Generator,
    *,
    octaves: int = 5,
    gain: float = 0.5,
) -> F32:
    """A sum of `octaves` smooth noises, each twice as fine and `gain` times as strong.

    The coarsest is white noise on a periodic lattice of `cells`, spread over `shape` by cubic
    B-splines. Octaves finer than two samples a cell are left out. Wraps around on every axis;
    mean 0, standard deviation 1; float32.
    """
    # The coarsest octave: white noise on the lattice.
    coefficients = rng.standard_normal(cells).astype(np.float32)
    for octave in range(1, octaves):
        if any(4 * n > size for n, size in zip(coefficients.shape, shape, strict=True)):
            break
        # A B-spline is a B-spline on the halved lattice too, so octaves add as coefficients
        # and the sum is spread over the samples once.
        coefficients = _halved(coefficients)
        fine = rng.standard_normal(coefficients.shape, dtype=np.float32)
        coefficients += np.float32(gain**octave) * fine
    # Values at the samples, of mean 0 and deviation 1.
    total = _spread(coefficients, shape)
    total -= total.mean()
    return cast(F32, total / np.float32(max(float(total.std()), 1e-12)))


def smoothstep(low: float, high: float, x: NDArray[np.floating[Any]]) -> F32:
    """0 below `low`, 1 above `high`, 3t^2 - 2t^3 between."""
    t = np.clip((x - np.float32(low)) / np.float32(high - low), 0.0, 1.0)
    return cast(F32, t * t * (3.0 - 2.0 * t))


def _halved(coefficients: F32) -> F32:
    """The same periodic cubic B-spline on a lattice twice as fine: Lane1980."""
    for axis in range(coefficients.ndim):
        # Splines split: even points are weighed 1 6 1, odd ones 1 1.
        before, after = np.roll(coefficients, 1, axis), np.roll(coefficients, -1, axis)
        even = (before + 6.0 * coefficients + after) / 8.0
        odd = (coefficients + after) / 2.0
        pair = np.stack([even, odd], axis=axis + 1)
        shape = list(coefficients.shape)
        shape[axis] *= 2
        coefficients = pair.reshape(shape)
    return coefficients.astype(np.float32)


def _spread(coefficients: F32, shape: tuple[int, ...]) -> F32:
    """The periodic spline's values at the centres of `shape` samples."""
    cells = coefficients.shape
    for axis, size in enumerate(shape):
        # Small products, one for each index of the axes before: nothing is copied or transposed.
        flat = coefficients.reshape(prod(shape[:axis]), cells[axis], -1)
        coefficients = _spline_weights(size, cells[axis]) @ flat
    return cast(F32, coefficients.reshape(shape))


def _spline_weights(size: int, count: int) -> F32:
    """(size, count) weights of the uniform cubic B-spline at sample centres, wrapping around."""
    at = (np.arange(size) + 0.5) * count / size
    cell = np.floor(at).astype(np.intp)
    t = at - cell
    # Four basis functions reach each sample.
    basis = [(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]
    weights = np.zeros((size, count), np.float32)
    for k, weight in enumerate(basis):
        np.add.at(weights, (np.arange(size), (cell + k - 1) % count), weight / 6.0)
    return weights
