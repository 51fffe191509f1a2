"""Groups of equal power, and groups that keep together what belongs together."""

from __future__ import annotations

import numpy as np

from airlight.area.strata import clusters, strata

RNG = np.random.default_rng(3)


def test_strata_have_the_same_power_and_every_row_once() -> None:
    points, power = RNG.uniform(size=(2000, 2)), RNG.uniform(0.5, 1.5, 2000)
    groups = strata(points, power, 16)
    assert sorted(np.concatenate(groups)) == list(range(2000))
    shares = np.array([power[rows].sum() for rows in groups]) / power.sum()
    # One row is 1/2000 of the whole, and each of four cuts is off by at most one.
    np.testing.assert_allclose(shares, 1.0 / 16.0, atol=4.0 / 2000.0)


def test_few_rows_make_few_strata() -> None:
    assert len(strata(np.zeros((3, 2)), np.ones(3), 16)) == 3


def test_clusters_divide_what_is_far_apart_and_keep_atoms_whole() -> None:
    near, far = RNG.normal(size=(40, 3)), RNG.normal(size=(40, 3), loc=(100, 0, 0))
    points, atoms = np.concatenate([near, far]), np.arange(80) // 8
    groups = clusters(points, np.ones(80), atoms, 2)
    assert sorted(map(len, groups)) == [40, 40]
    for most in (3, 5, 10, 30):
        groups = clusters(points, np.ones(80), atoms, most)
        assert len(groups) == min(most, 10)
        assert sorted(np.concatenate(groups)) == list(range(80))
        for rows in groups:
            assert all((np.isin(np.flatnonzero(atoms == a), rows)).all() for a in atoms[rows])


def test_dark_rows_are_left_out() -> None:
    power = np.array([0.0, 1.0, 0.0, 2.0])
    (group,) = clusters(np.zeros((4, 3)), power, np.zeros(4, int), 4)
    assert group.tolist() == [1, 3]
    assert clusters(np.zeros((4, 3)), np.zeros(4), np.zeros(4, int), 4) == []
