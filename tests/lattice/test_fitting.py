"""Cells that end at walls."""

import numpy as np
import pytest

from airlight.lattice.fitting import at_walls, walls_along
from airlight.lattice.placement import STRAIGHT, Placement, fitted
from airlight.scene import Material, Mesh
from airlight.scene.shapes import box, sphere

GREY = Material(base_color=(0.5, 0.5, 0.5))


def block(low, high):
    matrix = np.diag([*np.subtract(high, low), 1.0])
    matrix[:3, 3] = 0.5 * np.add(low, high)
    return Mesh(box(), GREY, matrix)


def off_faces(placement: Placement, axis: int, place: float) -> float:
    """Cells from a coordinate to the nearest face."""
    cells = (place - placement.origin[axis]) / placement.cell
    return abs(cells - round(cells))


def over(meshes, low, high, resolution=32):
    low, high = np.array(low, float), np.array(high, float)
    return at_walls(fitted(low, high, resolution), low, high, walls_along(meshes, STRAIGHT))


HALL = (12.0, 2.53, 12.0)


@pytest.mark.parametrize("shift", np.linspace(0.0, 0.9, 10))
def test_a_hall_has_as_many_rows_wherever_its_box_lies(shift):
    """A box of 5.06 cells; its lattice was for a larger one, shifted by tenths of a cell."""
    cell = 12.0 / 22
    low, high = np.array([0.0, 0.0, 0.0]), np.array(HALL)
    placement = over((block(low, high),), low - shift * cell, high + 1.0 * cell, 24)
    for axis in range(3):
        for place in (0.0, HALL[axis]):
            assert off_faces(placement, axis, place) < 0.08, (axis, place)
    rows = (HALL[1]) / placement.cell
    assert abs(rows - round(rows)) < 0.15


def test_walls_within_the_box_count_by_their_area():
    low, high = np.zeros(3), np.array([10.0, 10.0, 10.0])
    wall = block((0.0, 0.0, 3.3), (10.0, 10.0, 3.3001))
    step = block((0.0, 4.05, 0.0), (0.1, 4.0501, 0.1))
    placement = over((wall, step), low, high)
    assert off_faces(placement, 2, 3.3) < 1e-3
    # Sizes that a small thing alone asks for are not taken where a larger wall is worse off.
    assert off_faces(placement, 1, 4.05) < 0.025


def test_the_lattice_holds_the_box_with_a_cell_to_spare():
    rng = np.random.default_rng(3)
    for _ in range(50):
        low = rng.uniform(-5.0, 5.0, 3)
        high = low + rng.uniform(0.5, 9.0, 3)
        inner = low + rng.uniform(0.0, 0.4, 3) * (high - low)
        made = over((block(inner, high),), low, high)
        usual = fitted(low, high, 32)
        begin, end = made.bounds
        for margin in ((low - begin) / made.cell, (end - high) / made.cell):
            assert margin.min() > 1.0 - 1e-3
            assert margin.max() < 3.0 + 1e-3
        assert usual.cell <= made.cell <= 1.1001 * usual.cell
        assert max(made.count) <= 32
        assert all(n % 2 == 0 for n in made.count)


def test_what_is_no_wall_leaves_the_lattice_as_it_is():
    ball = Mesh(sphere(), GREY, np.eye(4))
    turn = np.eye(4)
    c, s = np.cos(0.5), np.sin(0.5)
    turn[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, c, -s], [0, s, c]]
    )
    aslant = Mesh(box(), GREY, turn)
    low, high = np.full(3, -1.0), np.full(3, 1.0)
    usual = fitted(low, high, 16)
    assert over((aslant,), low, high, 16) == usual
    assert over((), low, high, 16) == usual
    # A ball has hardly any.
    assert sum(areas.sum() for _, areas in walls_along((ball,), STRAIGHT)) < 0.1


def test_walls_do_not_depend_on_how_they_are_cut():
    whole = walls_along((block((0, 0, 0), (2, 1, 1)),), STRAIGHT)
    parts = walls_along((block((0, 0, 0), (1, 1, 1)), block((1, 0, 0), (2, 1, 1))), STRAIGHT)
    for axis in (1, 2):
        for found in (whole, parts):
            places, areas = found[axis]
            assert areas[np.abs(places) < 1e-9].sum() == pytest.approx(2.0)
