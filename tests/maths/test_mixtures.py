"""Few materials are found where there are few, and nothing is lost where there are none."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.mixtures import EXACT, mixed


@pytest.mark.parametrize("count", [1, 2, 3])
def test_mixtures_of_a_few_are_found(count):
    rng = np.random.default_rng(count)
    materials = rng.random((count, 6))
    shares = rng.dirichlet(np.full(count, 0.3), 4000) * rng.uniform(0.1, 5.0, (4000, 1))
    shares[:count] = np.eye(count)  # each pure somewhere
    shares[5] = 0.0
    rows = (shares @ materials).astype(np.float32)
    found, of = mixed(rows)
    assert of.shape == (count, 6)
    assert found.min() >= 0.0
    assert of.min() >= 0.0
    np.testing.assert_allclose(found @ of, rows, atol=2.0 * EXACT * rows.sum(axis=1).max())


def test_colours_without_order_are_kept_number_by_number():
    rng = np.random.default_rng(3)
    rows = rng.random((3000, 6)).astype(np.float32)
    rows[:, 4] = 0.5 * rows[:, 3]  # always in one ratio: one material
    rows[:, 5] = 0.0
    found, of = mixed(rows)
    assert of.shape == (4, 6)
    np.testing.assert_allclose(found @ of, rows, rtol=1e-5)


def test_nothing_is_mixed_of_nothing():
    found, of = mixed(np.zeros((10, 6), np.float32))
    assert found.shape == (10, 0)
    assert of.shape == (0, 6)
