"""Cells over a box: they cover it, are cubic, even in number; bad boxes are refused."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.lattice.placement import Placement, fitted

RNG = np.random.default_rng(4)
BOXES = [
    ((0, 0, 0), (1, 1, 1)),
    ((-3, 0, 2), (5, 1, 2.5)),
    ((0, 0, 0), (10, 0, 10)),
    *[(low, low + RNG.uniform(0.1, 9.0, 3)) for low in RNG.uniform(-5, 5, (20, 3))],
]


@pytest.mark.parametrize("resolution", [4, 15, 16, 32])
@pytest.mark.parametrize("box", BOXES)
def test_the_box_is_covered_with_room_around_it(box, resolution):
    low, high = (np.asarray(side, dtype=np.float64) for side in box)
    made = fitted(low, high, resolution)
    lower, upper = made.bounds
    assert (lower <= low - 0.49 * made.cell).all()
    assert (upper >= high + 0.49 * made.cell).all()
    np.testing.assert_allclose(lower + upper, low + high, atol=1e-9)  # centred
    assert all(n % 2 == 0 and n >= 2 for n in made.count)
    assert max(made.count) <= resolution + 1
    assert made.cell == pytest.approx((high - low).max() / (resolution - 2))
    assert made.cells == np.prod(made.count)


@pytest.mark.parametrize(
    ("low", "high", "resolution", "message"),
    [
        ((1, 1, 1), (1, 1, 1), 16, "the lattice has no size: [1, 1, 1] to [1, 1, 1]"),
        ((0, 0, 0), (float("inf"), 1, 1), 16, "the lattice has no size: [0, 0, 0] to [inf, 1, 1]"),
        ((0, 0, 0), (1, 1, 1), 3, "resolution = 3 is too small for a lattice"),
    ],
)
def test_bad_boxes_are_refused(low, high, resolution, message):
    with pytest.raises(SettingsError) as caught:
        fitted(low, high, resolution)
    assert str(caught.value) == message


def test_a_turned_box_is_told_along_its_axes_and_held_by_a_box_of_the_world():
    axes = ((0.6, 0.0, -0.8), (0.0, 1.0, 0.0), (0.8, 0.0, 0.6))
    made = fitted((0.0, 0.0, 0.0), (2.0, 1.0, 4.0), 10, axes)
    assert made.axes == axes
    corners = np.array(np.meshgrid(*zip(*made.bounds, strict=True))).reshape(3, 8).T @ axes
    low, high = made.world_bounds
    np.testing.assert_allclose([low, high], [corners.min(axis=0), corners.max(axis=0)])
    assert made.params().record["axis_z"].tolist() == pytest.approx([0.8, 0.0, 0.6])


def test_shaders_get_the_same_placement():
    record = Placement((1, 2, 3), 0.5, (4, 6, 8)).params(16.0, is_paper=True).record
    assert record["origin"].tolist() == [1, 2, 3]
    assert record["count"].tolist() == [4, 6, 8]
    assert (record["cell"], record["power_scale"], record["is_paper"]) == (0.5, 16.0, 1)
