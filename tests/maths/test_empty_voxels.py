"""What is said to be empty is, by the trilinear density itself."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from airlight.maths.empty_voxels import RADII, empty_distances, free_voxels

RNG = np.random.default_rng(8)
SHAPE = (24, 30, 40)


def specks(count: int) -> np.ndarray:
    density = np.zeros(SHAPE, np.float32)
    density[tuple(RNG.integers(0, n, count) for n in SHAPE)] = 1.0
    return density


def trilinear(values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Of voxels at points (n, 3) in voxels, z, y, x, clamped as a texture is."""
    at = np.clip(points - 0.5, 0.0, np.array(values.shape) - 1.0)
    low = np.minimum(np.floor(at).astype(int), np.array(values.shape) - 2)
    t = at - low
    total = np.zeros(len(points))
    for corner in product((0, 1), repeat=3):
        weight = np.prod(np.where(corner, t, 1.0 - t), axis=1)
        total += weight * values[tuple((low + corner).T)]
    return total


@pytest.mark.parametrize("count", [1, 6, 60])
def test_distances_are_those_of_the_nearest_speck_in_steps_of_two(count: int) -> None:
    density = specks(count)
    voxels = np.stack(np.indices(SHAPE), axis=-1).reshape(-1, 1, 3)
    away = np.abs(voxels - np.argwhere(density)[None]).max(axis=-1).min(axis=-1).reshape(SHAPE)
    # The largest of 0, 1 and the radii plus one that is not beyond the nearest.
    known = np.array([0, 1, *(r + 1 for r in RADII)])
    expected = known[np.searchsorted(known, away, side="right") - 1]
    np.testing.assert_array_equal(empty_distances(density), expected)


def test_nothing_is_in_what_is_free() -> None:
    density = specks(6)
    points = RNG.uniform(0.0, 1.0, (4000, 3)) * SHAPE
    free = free_voxels(trilinear(empty_distances(density).astype(float), points))
    assert (free > 2.0).mean() > 0.25
    for _ in range(20):
        there = points + RNG.uniform(-1.0, 1.0, points.shape) * free[:, None]
        # What matter reaches outside its grid nobody asks for.
        inside = ((there >= 0.0) & (there <= SHAPE)).all(axis=1)
        assert trilinear(density, there[inside]).max(initial=0.0, where=free[inside] > 0.0) == 0.0


def test_a_grid_that_holds_nothing_is_empty() -> None:
    assert (empty_distances(np.zeros(SHAPE)) == RADII[-1] + 1).all()
