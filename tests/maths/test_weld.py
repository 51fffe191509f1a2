"""Vertices at one position have one number."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import weld
from airlight.maths.weld import open_vertices, welded


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_equal_points_share_a_number_and_others_do_not(dtype):
    rng = np.random.default_rng(0)
    distinct = np.unique(rng.normal(size=(500, 3)).astype(dtype), axis=0)
    chosen = rng.integers(0, len(distinct), 4000)
    numbers = welded(distinct[chosen])
    pairs = np.unique(np.stack([chosen, numbers], axis=1), axis=0)
    used = len(np.unique(chosen))
    assert len(pairs) == used
    np.testing.assert_array_equal(np.unique(numbers), np.arange(used))


def test_distinct_points_keep_their_order():
    points = np.random.default_rng(1).normal(size=(100, 3))
    np.testing.assert_array_equal(welded(points), np.arange(100))


def test_the_sign_of_zero_does_not_matter():
    np.testing.assert_array_equal(welded(np.array([(0.0, -0.0, 1.0), (-0.0, 0.0, 1.0)])), [0, 0])


def test_points_whose_hashes_collide_stay_apart(monkeypatch):
    monkeypatch.setattr(weld, "_hashes", lambda points: np.zeros(len(points), np.uint64))
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 0, 0), (1, 0, 0)], float)
    numbers = welded(points)
    assert numbers[0] == numbers[2] != numbers[1] == numbers[3]


def test_the_vertices_at_a_rim_are_open():
    fan = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)])
    np.testing.assert_array_equal(open_vertices(fan), [False, True, True, True, True])
    closed = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
    assert not open_vertices(closed).any()
