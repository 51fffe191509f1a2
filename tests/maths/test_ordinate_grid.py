"""Turned grids span the medium, hold its air, and give back what was put in."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.ordinate_grid import grid_density, ordinate_grids, read_back
from airlight.maths.ordinates import uniform_sky


def test_a_grid_along_an_axis_is_the_box_itself():
    for d in np.concatenate([np.eye(3), -np.eye(3)]):
        grids = ordinate_grids((1.0, 1.0, 1.0), d, 16**3)
        np.testing.assert_array_equal(grids.count[0], 16)
        assert grids.cell[0] == pytest.approx(1.0 / 16.0)
        centres = grids.centres(0)
        assert centres.min() == pytest.approx(1.0 / 32.0)
        assert centres.max() == pytest.approx(1.0 - 1.0 / 32.0)
        density = grid_density(grids, 0, np.ones((8, 8, 8)), np.ones(3))
        # A mean of eight samples of eight voxels: each sum rounds as often as it adds.
        np.testing.assert_allclose(density, 1.0, rtol=16.0 * np.finfo(np.float64).eps)


@pytest.mark.parametrize("extent", [(1.0, 1.0, 1.0), (2.4, 4.8, 2.4), (1.0, 0.02, 3.0)])
def test_turned_grids_span_the_box_with_few_enough_cells(extent):
    sky = uniform_sky(24)
    size = np.array(extent)
    grids = ordinate_grids(size, sky.direction, 12**3)
    assert (grids.count.prod(axis=1) <= 12**3).all()
    assert (grids.count.prod(axis=1) > 0.4 * 12**3).all()
    corners = np.array(list(np.ndindex(2, 2, 2))) * size
    for n in range(24):
        place = grids.places(n, corners)
        assert place.min() > -1e-5
        assert (place < grids.count[n] + 1e-5).all()
        np.testing.assert_allclose(grids.axes[n] @ grids.axes[n].T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(grids.places(n, grids.centres(n))[0, 0, 0], 0.5)


def test_turned_grids_hold_the_mediums_mass():
    rng = np.random.default_rng(2)
    fine = rng.random((24, 24, 24))
    grids = ordinate_grids(np.ones(3), uniform_sky(8).direction, 20**3)
    for n in range(8):
        mass = grid_density(grids, n, fine, np.ones(3)).sum() * grids.cell[n] ** 3
        assert mass == pytest.approx(fine.mean(), rel=0.02)


def test_empty_cells_have_no_say():
    density = np.zeros((4, 4, 4))
    density[:2] = 2.0
    values = np.full((4, 4, 4, 1), 100.0)
    values[:2] = 3.0
    at = np.array([[2.0, 2.0, 1.0], [2.0, 2.0, 1.9], [2.0, 2.0, 3.5]])
    np.testing.assert_allclose(read_back(at, density, values)[:, 0], [3.0, 3.0, 0.0])
