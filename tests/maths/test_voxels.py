"""Boxes averaged exactly, and the density that light has passed."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.medium import ray_box_interval
from airlight.maths.voxels import (
    box_averaged,
    density_behind,
    ratio,
    samples_per_cell,
    trilinear,
)

RNG = np.random.default_rng(7)
DIRECTIONS = [(0, 0, 1), (0, -1, 0), (0.48, -0.64, 0.6), (-0.36, 0.48, -0.8)]


def test_averages_keep_the_mean_and_a_constant():
    grid = RNG.random((12, 8, 20))
    assert box_averaged(grid, (10, 4, 6)).shape == (6, 4, 10)
    np.testing.assert_allclose(box_averaged(grid, (10, 4, 6)), blocks(grid))
    np.testing.assert_allclose(box_averaged(grid, (20, 8, 12)), grid)
    np.testing.assert_allclose(box_averaged(np.full((3, 5, 7), 2.5), (9, 9, 9)), 2.5)
    assert [samples_per_cell(*v) for v in ((20, 10), (21, 10), (5, 10), (999, 2))] == [2, 3, 1, 16]


def blocks(grid):
    z, y, x = grid.shape
    return grid.reshape(z // 2, 2, y // 2, 2, x // 2, 2).mean(axis=(1, 3, 5))


def test_a_ramp_is_interpolated_exactly():
    x = np.arange(6.0) + 0.5
    grid = np.broadcast_to(x, (3, 4, 6))
    at = RNG.uniform(0.5, 2.5, (50, 3)) * [2.0, 1.0, 1.0]
    np.testing.assert_allclose(trilinear(grid, at), at[:, 0])
    assert trilinear(grid, np.array([-3.0, 0, 0])) == 0.5


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_what_light_has_passed_inside_a_box_is_its_path(direction):
    extent = np.array([1.0, 1.4, 0.8])
    points = RNG.uniform(0.0, 1.0, (200, 3)) * extent
    _, path = ray_box_interval(points, -np.asarray(direction), np.zeros(3), extent)
    for step in (0.05, 0.4):
        got = density_behind(np.ones((4, 4, 4)), extent, points, direction, step)
        np.testing.assert_allclose(got, path, atol=1e-12)


def test_a_layered_box_is_the_integral_of_its_layers():
    layers = np.array([0.0, 2.0, 1.0, 0.0, 3.0, 1.0])
    density = np.broadcast_to(layers[:, None, None], (6, 2, 2))
    at = np.array([[0.5, 0.5, 6.0]])
    got = density_behind(density, np.array([1.0, 1.0, 6.0]), at, (0, 0, 1), 0.05)
    assert got[0] == pytest.approx(layers.sum(), rel=2e-3)


def test_a_ratio_does_not_fall_off_towards_what_is_empty():
    rng = np.random.default_rng(3)
    whole = rng.random((6, 7, 8, 3))
    whole[rng.random((6, 7, 8)) < 0.5] = 0.0
    whole[:, :, 4:] = 0.0
    found = ratio(0.7 * whole, whole)
    near = np.zeros((8, 9, 10), bool)
    for k in np.ndindex(3, 3, 3):
        near[k[0] : k[0] + 6, k[1] : k[1] + 7, k[2] : k[2] + 8] |= whole[..., 0] > 0.0
    near = near[1:-1, 1:-1, 1:-1]
    np.testing.assert_allclose(found[near], 0.7, rtol=1e-12)
    assert (found[~near] == 0.0).all() and not near.all()
    # Where there is matter on both sides, the empty voxel lies between them.
    line = ratio(np.array([[[0.2, 0.0, 0.9]]]), np.array([[[1.0, 0.0, 1.0]]]))
    np.testing.assert_allclose(line, [[[0.2, 0.55, 0.9]]])
