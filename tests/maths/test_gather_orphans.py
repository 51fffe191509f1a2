"""Which pixels get gather points of their own, and whose light others take; WGSL against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import gather, gather_orphans
from airlight.maths.sampling import fibonacci_sphere

RNG = np.random.default_rng(18)
UP = np.array([0.0, 0.0, 1.0])


def test_a_list_holds_as_many_as_fit_evenly_spread():
    """90 of 1000 things: each run of 100 has 9, and over all phases each is in it as often."""
    counted = np.zeros(1000, dtype=int)
    for phase in range(1000):
        before = gather_orphans.listed_before(np.arange(1001), 1000, 90, phase).astype(int)
        listed = np.diff(before)
        assert before[0] == 0 and before[-1] == 90 and listed.max() == 1
        assert set(np.diff(before[::100])) == {9}
        counted += listed
    assert set(counted) == {90}
    np.testing.assert_array_equal(
        gather_orphans.listed_before(np.arange(9), 8, 90, 3), np.arange(9)
    )


def test_a_list_is_the_same_on_the_device(wgsl):
    index, phase = np.arange(1001, dtype=np.uint32), np.full(1001, 7, dtype=np.uint32)
    for count in (1000, 80):
        sizes = (np.full(1001, value, dtype=np.uint32) for value in (count, 90))
        found = wgsl("gather_orphans", "listed_before", index, *sizes, phase, returns="u32")
        np.testing.assert_array_equal(found, gather_orphans.listed_before(index, count, 90, 7))


@pytest.mark.parametrize("side", [1, 2, 3, 6, 7, 16])
def test_all_pixels_of_a_block_are_tried(side):
    step = gather_orphans.orphan_step(side)
    assert len({k * step % side**2 for k in range(side**2)}) == side**2


def test_kin_face_one_way_and_are_near():
    """Beside surfaces 2 m off, 10 cm count for nearly all, 2 m for little; the other side never."""
    near = gather.nearness(UP, 0.5, 0.0)
    for offset, least, most in ((0.1, 0.95, 1.0), (2.0, 0.0, 0.05)):
        kin = gather_orphans.kinship(UP, UP, np.array([0.0, 0.0, offset]), *near)
        assert least <= kin <= most
    assert gather_orphans.kinship(UP, -UP, np.zeros(3), *near) == 0.0


def test_kin_are_the_same_on_the_device(wgsl):
    n, offset = fibonacci_sphere(500), 0.5 * RNG.normal(size=(500, 3))
    m, near = n[::-1], gather.nearness(n, RNG.random(500) + 0.5, RNG.random(500))
    found = wgsl("gather_orphans", "kinship", n, m, offset, *near, returns="f32")
    twin = gather_orphans.kinship(n, m, offset, *near)
    np.testing.assert_allclose(found, twin, rtol=1e-3, atol=1e-6)
