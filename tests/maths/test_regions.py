"""Regions of cells, and what light between them comes to."""

import numpy as np

from airlight.maths.regions import (
    REGIONS,
    corrected,
    exchange,
    flooded,
    gain,
    region_grid,
    sums_of,
)

COUNT = (12, 8, 10)
SHAPE = COUNT[::-1]


def test_regions_are_about_cubes_and_few():
    for count in ((32, 32, 32), (32, 8, 32), (24, 10, 24), (4, 4, 4), (200, 3, 3)):
        grid = region_grid(count)
        assert np.prod(grid) <= REGIONS
        sides = np.array(count) / grid
        assert sides.min() >= 1.0
        assert np.prod(grid) > REGIONS // 3 or max(count) < 12 or min(count) < 4


def test_open_cells_belong_to_the_nearest_middle():
    regions = flooded(COUNT, np.ones((6, *SHAPE)))
    assert regions.min() == 0
    assert regions.max() == np.prod(region_grid(COUNT)) - 1
    # All regions of an open box are about as large.
    counts = sums_of(regions, np.ones(SHAPE))[: regions.max() + 1]
    assert counts.min() > 0.3 * counts.mean()


def test_no_region_reaches_through_a_wall():
    # A wall across x between cells 6 and 7, not where regions part.
    faces = np.ones((6, *SHAPE))
    faces[0, :, :, 7] = faces[1, :, :, 6] = 0.2
    regions = flooded(COUNT, faces)
    left, right = np.unique(regions[..., :7]), np.unique(regions[..., 7:])
    assert not set(left) & set(right)
    # With a door in it they do.
    faces[:, 4:7, :4] = 1.0
    regions = flooded(COUNT, faces)
    assert set(regions[..., :7].ravel()) & set(regions[..., 7:].ravel())


def test_a_cell_behind_closed_faces_is_of_no_region():
    faces = np.ones((6, *SHAPE))
    faces[:, 0, 0, 0] = 0.0
    regions = flooded(COUNT, faces)
    assert regions[0, 0, 0] == -1
    assert (regions == -1).sum() == 1


def test_a_room_whose_walls_hold_the_middles_of_boxes_has_regions_of_its_own():
    """Light goes out of a wall's cells to both sides, and comes into none: regions that began there
    were in the room and outside, and 24 steps brought it 1.11 times its light."""
    count = (36, 12, 12)
    faces = np.ones((6, *count[::-1]))
    inside, wall = np.zeros((2, *count[::-1]), bool)
    wall[3:10, 3:10, 3:33] = True
    inside[4:9, 4:9, 4:32] = True
    wall &= ~inside
    part, middle = np.array(region_grid(count)), 3
    assert (12 // (2 * part[1]), 12 // (2 * part[2])) == (middle, middle)
    assert wall[middle, middle, 3:33].all()
    for hop in range(6):
        # Whoever comes into a wall's cell from elsewhere is stopped.
        came_from = np.roll(wall, 1 if hop % 2 == 0 else -1, axis=2 - hop // 2)
        faces[hop][wall & ~came_from] = 0.0
    regions = flooded(count, faces)
    outside = ~inside & ~wall
    assert (regions[inside] >= 0).all()
    assert (regions[outside] >= 0).all()
    assert not set(regions[inside]) & set(regions[outside])
    assert 4 <= len(set(regions[inside])) <= regions.max() < REGIONS


def chain(bonds):
    """A step of a row of cells: shares go over between neighbours, and leave at the ends."""

    def step(power):
        out = power * (1.0 - bonds[:-1] - bonds[1:])
        out[..., 1:] += bonds[1:-1] * power[..., :-1]
        out[..., :-1] += bonds[1:-1] * power[..., 1:]
        return out

    return step


def test_light_that_is_alike_in_each_region_is_finished_at_once():
    """Where light hardly gets from region to region, steps alone take hundreds."""
    bonds = np.full(13, 0.3)
    bonds[[0, 4, 8, 12]] = 0.002
    step = chain(bonds)
    regions = np.repeat([0, 1, 2], 4).reshape(1, 1, 12)
    source = np.zeros((1, 1, 12))
    source[..., :4] = 1.0
    matrix = np.array([step(e.reshape(1, 1, 12)).ravel() for e in np.eye(12)]).T
    total = np.linalg.solve(np.eye(12) - matrix, source.ravel())
    gained = gain(exchange(regions, step), regions)
    known, plain = source, source
    for _ in range(12):
        known = corrected(known, source + step(known), regions, gained)
        plain = source + step(plain)
    error = np.linalg.norm(known.ravel() - total) / np.linalg.norm(total)
    before = np.linalg.norm(plain.ravel() - total) / np.linalg.norm(total)
    assert error < 0.05 < 0.9 < before


def test_cells_of_no_region_and_regions_without_cells_change_nothing():
    regions = np.array([[[0, 0, -1, 5]]])
    gained = gain(exchange(regions, lambda power: 0.5 * power), regions)
    after = corrected(np.zeros((1, 1, 4)), np.ones((1, 1, 4)), regions, gained)
    # 1 + 1/2 + 1/4 + ... = 2 but for the least share that regions lose.
    np.testing.assert_allclose(after, [[[2.0, 2.0, 1.0, 2.0]]], rtol=5e-3)
