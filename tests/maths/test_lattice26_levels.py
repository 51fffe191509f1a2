"""Coarse lattices: restriction, matched deposits, and a two-level solve that converges."""

import numpy as np
import pytest

from airlight.maths import lattice26, lattice26_levels
from airlight.maths.medium import mean_absorption_depth


def test_level_zero_is_the_physical_deposit():
    x = np.array([1e-3, 0.1, 1.0, 10.0])
    np.testing.assert_array_equal(
        lattice26_levels.coarse_absorption_depth(x, 0), mean_absorption_depth(x)
    )


def test_the_coarse_walk_has_the_fine_walks_diffusion():
    """Mean squared path between scatterings, by summing hops, in fine hops."""
    x = 1.2
    for level in (1, 2):
        fine = squared_path(x / 2**level, mean_absorption_depth(x / 2**level))
        place = lattice26_levels.coarse_absorption_depth(x, level)
        assert squared_path(x, place) * 4**level == pytest.approx(fine, rel=1e-9)


def squared_path(x: float, place: float) -> float:
    """Sum over k hops passed, then the deposit behind or ahead."""
    k = np.arange(4000)
    return float((np.exp(-k * x) * -np.expm1(-x)) @ ((1 - place) * k**2 + place * (k + 1) ** 2))


def test_the_limit_of_thin_air_is_met_without_a_step():
    below, above = lattice26_levels.coarse_absorption_depth([0.99e-3, 1.01e-3], 1)
    assert abs(below - above) < 3e-4


def test_mean_track_is_what_a_step_leaves():
    state = np.zeros((1, 5, 5, 5, 4))
    state[0, 2, 2, 2, 0] = 1.0
    sigma = np.full((1, 5, 5, 5), 0.7)
    _, _, track = lattice26.half_linear_step(state, 0 * sigma, sigma, 0.6)
    assert track[..., 0].sum() == pytest.approx(float(lattice26_levels.mean_track(0.7, 0.6)))


def test_restriction_sums_and_prolongation_repeats_odd_sides_too():
    fine = np.random.default_rng(1).random((2, 3, 4, 5, 4))
    coarse = lattice26_levels.restricted(fine)
    assert coarse.shape == (2, 2, 2, 3, 4)
    np.testing.assert_allclose(coarse.sum(axis=(1, 2, 3)), fine.sum(axis=(1, 2, 3)))
    constant = np.full((1, 3, 4, 5), 2.5)
    np.testing.assert_allclose(lattice26_levels.restricted(constant, is_mean=True), 2.5)
    again = lattice26_levels.prolonged(coarse, (3, 4, 5))
    assert again.shape == fine.shape
    np.testing.assert_array_equal(again[:, 0, 0, 0], again[:, 1, 1, 1])


def test_walls_inside_a_coarse_cell_count_on_both_its_faces():
    faces = np.ones((6, 4, 4, 8))
    faces[0, :, :, 3], faces[1, :, :, 2] = 0.0, 0.0  # a plane inside coarse cell 1
    faces[0, :, :, 6], faces[1, :, :, 5] = 0.0, 0.0  # a plane on coarse cell 3's low face
    coarse = lattice26_levels.restricted_faces(faces)
    np.testing.assert_allclose(coarse[0, 0, 0], [1.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(coarse[1, 0, 0], [0.0, 0.0, 0.0, 1.0])
    np.testing.assert_allclose(coarse[2:], 1.0)
