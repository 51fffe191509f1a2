"""Where nested lattices are, and where one hands over to the next."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from airlight.lattice.nested import (
    BORDER,
    SLACK,
    faded,
    must_move,
    nested,
    shares,
    snapped,
    surrounded,
    wanted_centre,
)
from airlight.lattice.placement import fitted

HALL = ((-20.0, -1.0, -8.0), (20.0, 9.0, 8.0))
STEPS = np.linspace(-30.0, 30.0, 601)
RIGHT = np.array([1.0, 0.0, 0.0])


def weight(placement, point):
    """As wgsl/lattice.wgsl has it."""
    f = placement.fade
    low = (point - np.array(f.low)) / np.array(f.low_width)
    high = (np.array(f.high) - point) / np.array(f.high_width)
    return float(np.clip(np.minimum(low, high).min(), 0.0, 1.0))


def walk(nest, level, eyes):
    """(placement, centre) after each step of the eye, looking along +x."""
    place = None
    for eye in eyes:
        centre = wanted_centre(nest, level, np.asarray(eye, float), RIGHT)
        place = snapped(nest, level, centre, place)
        yield faded(nest, level, place, centre), centre


def test_one_lattice_is_the_fitted_one():
    nest = nested(*HALL, 32)
    assert nest.levels == (fitted(*HALL, 32),)
    assert not nest.follows(0)


def test_cells_shrink_by_the_ratio_and_the_coarsest_covers_the_box():
    nest = nested(*HALL, 32, count=3, ratio=2.0)
    cells = [level.cell for level in nest.levels]
    assert cells[1] / cells[0] == pytest.approx(2.0)
    assert cells[2] / cells[1] == pytest.approx(2.0)
    low, high = nest.levels[-1].bounds
    assert (low < HALL[0]).all() and (high > HALL[1]).all()
    assert [nest.follows(k) for k in range(3)] == [True, True, False]


def test_rows_of_shared_textures_do_not_overlap():
    nest = nested(*HALL, 16, count=4)
    ends = [(p.first_row, p.first_row + p.count[1]) for p in nest.levels]
    assert all(a[1] == b[0] for a, b in pairwise(ends))
    assert nest.texture_size[1] == ends[-1][1]
    assert all(c <= s for p in nest.levels for c, s in zip(p.count, nest.texture_size, strict=True))


def test_with_a_given_extent_the_coarsest_still_covers_the_box():
    nest = nested(*HALL, 16, count=3, ratio=2.0, finest_m=4.0)
    assert nest.levels[0].cell == pytest.approx(0.25)
    assert nest.levels[1].cell == pytest.approx(0.5)
    assert nest.levels[2].cell == pytest.approx(fitted(*HALL, 16).cell)
    assert not nest.follows(2)


def test_lattices_that_would_be_no_finer_are_left_out():
    nest = nested(*HALL, 16, count=4, ratio=4.0, finest_m=8.0)
    cells = [level.cell for level in nest.levels]
    assert cells == sorted(cells) and len(cells) == 3  # .5, 2, and the hall's own
    assert not nest.follows(2)
    assert nest.levels[-1].cell == pytest.approx(fitted(*HALL, 16).cell)


def test_one_lattice_more_lies_around_all_others():
    around = ((-90.0, -10.0, -70.0), (80.0, 40.0, 60.0))
    alone, nest = nested(*HALL, 48, count=3), surrounded(nested(*HALL, 48, count=3), around, 48)
    # The others are what they are without it, but for the borders at which it takes over; what is
    # finer ends inside of those.
    assert nest.levels[:2] == alone.levels[:2]
    assert replace(nest.over_inner, fade=None) == alone.over_inner == alone.levels[2]
    assert [nest.follows(k) for k in range(4)] == [True, True, False, False]
    low, high = nest.levels[3].bounds
    assert (low <= around[0]).all() and (high >= around[1]).all()
    # All of the light beyond the hall's lattice is its own, in the hall's middle none.
    points = np.array([0.5 * np.add(*HALL), [60.0, 20.0, 50.0], [-80.0, 0.0, 0.0]])
    found = shares(nest.levels[2:], points)
    np.testing.assert_allclose(found, [[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]])


def test_where_the_outer_box_ends_with_the_inner_one_nothing_fades():
    """At the floor that the fog lies on."""
    low, high = HALL
    around = ((low[0] - 60.0, low[1], low[2] - 60.0), np.add(high, 60.0))
    nest = surrounded(nested(*HALL, 48, count=2), around, 48)
    for place, _ in walk(nest, 0, [(0.3, 2.0, 1.0)]):
        assert place.fade.low[1] < -1000.0 < place.fade.low[0]
        whole = nest.over_inner.fade
        assert whole.low[1] + whole.low_width[1] <= low[1]
        assert whole.low[0] > low[0]


def test_lattices_stay_where_they_are_for_inside_of_the_one_around_them():
    nest = surrounded(nested(*HALL, 48, count=2), ((-900.0,) * 3, (900.0,) * 3), 48)
    fade = nest.over_inner.fade
    for place, centre in walk(nest, 0, [(-500.0, 90.0, 3.0), (900.0, -50.0, 0.0)]):
        low, high = place.bounds
        assert (high > HALL[0]).all() and (low < HALL[1]).all()
        assert not must_move(place, centre)
        # But for half a cell it is where the largest of them has all of the light.
        half = 0.5 * place.cell + 1e-9
        assert place.fade.low[0] >= fade.low[0] + fade.low_width[0] - half
        assert place.fade.high[0] <= fade.high[0] - fade.high_width[0] + half


def test_a_lattice_moves_in_whole_cells_of_the_common_grid():
    nest = nested(*HALL, 32, count=3)
    base = np.array(nest.levels[-1].origin)
    for level in (0, 1):
        cell = nest.levels[level].cell
        for place, _ in walk(nest, level, [(x, 2.0, 1.0) for x in STEPS]):
            offset = (np.array(place.origin) - base) / cell
            np.testing.assert_allclose(offset, np.round(offset), atol=1e-6)


def test_an_eye_that_trembles_moves_nothing():
    nest = nested(*HALL, 32, count=2)
    tremble = 0.2 * nest.levels[0].cell * np.random.default_rng(1).uniform(-1, 1, (50, 3))
    eyes = np.array([0.3, 2.0, 1.0]) + np.concatenate([np.zeros((1, 3)), tremble])
    origins = {place.origin for place, _ in walk(nest, 0, eyes)}
    assert len(origins) == 1


def test_a_lattice_is_displaced_along_the_view():
    nest = nested(*HALL, 32, count=2)
    eye = np.array([0.0, 4.0, 0.0])
    ahead = wanted_centre(nest, 0, eye, RIGHT)
    back = wanted_centre(nest, 0, eye, -RIGHT)
    half = 0.5 * nest.levels[0].cell * nest.levels[0].count[0]
    assert ahead[0] == pytest.approx(0.5 * half)
    assert back[0] == pytest.approx(-0.5 * half)


def test_a_lattice_stays_at_the_scene_when_the_camera_is_far_outside():
    nest = nested(*HALL, 32, count=3)
    for place, centre in walk(nest, 0, [(-500.0, 90.0, 3.0), (900.0, -50.0, 0.0)]):
        low, high = place.bounds
        assert (high > HALL[0]).all() and (low < HALL[1]).all()
        assert not must_move(place, centre)


def test_what_surfaces_read_is_at_hand_and_changes_as_little_as_the_eye():
    nest = nested(*HALL, 32, count=2)
    cell = nest.levels[0].cell
    inside = np.random.default_rng(2).uniform(*HALL, (200, 3))
    before, largest = None, 0.0
    for place, _ in walk(nest, 0, [(x, 2.0, 1.0) for x in STEPS]):
        weights = np.array([weight(place, p) for p in inside])
        low, high = place.bounds
        read = inside[weights > 0.0]
        # past the last cell only by the slack and, near the hall's ends, a cell
        over = (1.0 + SLACK) * cell
        assert (read > low - over).all() and (read < high + over).all()
        if before is not None:
            largest = max(largest, np.abs(weights - before).max())
        before = weights
    step = STEPS[1] - STEPS[0]
    assert largest <= step / cell


def test_a_lattice_as_large_as_the_box_hands_nothing_over():
    nest = nested((0, 0, 0), (4, 1, 1), 16, count=2)
    centre = wanted_centre(nest, 0, np.array([2.0, 0.5, 0.5]), RIGHT)
    place = faded(nest, 0, snapped(nest, 0, centre, None), centre)
    for y in (0.0, 0.5, 1.0):  # the finer one is as high as the box
        assert weight(place, np.array([centre[0], y, 0.5])) == 1.0
    assert weight(place, np.array([centre[0] - 3.0, 0.5, 0.5])) == 0.0


def test_slack_leaves_room_for_the_border():
    assert SLACK < BORDER


def test_shares_of_nested_lattices_add_up():
    nest = nested(*HALL, 32, count=3)
    eye = np.array([1.0, 2.0, 0.5])
    levels = []
    for k in range(3):
        centre = wanted_centre(nest, k, eye, RIGHT)
        place = snapped(nest, k, centre, None) if nest.follows(k) else nest.levels[k]
        levels.append(faded(nest, k, place, centre))
    points = np.random.default_rng(3).uniform(*HALL, (300, 3))
    given = shares(levels, points)
    np.testing.assert_allclose(given.sum(axis=0), 1.0)
    np.testing.assert_allclose(given[0], [weight(levels[0], p) for p in points])
    assert (given.max(axis=1) == 1.0).all()  # each has some place of its own
