"""Slices: which way is up, where walls are drawn, what the colours and arrows mean."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.figures import clpv_debug, slices
from airlight.figures.panels import Request
from airlight.figures.slices import SolvedLattice, cut, from_texels, slice_image
from airlight.maths.lattice6 import LOOKUP_SCALE

SHAPE = (3, 4, 5)  # z, y, x


def empty(**changes):
    given = {"intensity": np.zeros((*SHAPE, 3, 4)), "openness": np.ones((*SHAPE, 6)), "cell_m": 0.5}
    return SolvedLattice(**{**given, **changes})


def test_up_is_up():
    z, y, x = np.indices(SHAPE)
    world = np.stack([x, y, z], axis=-1)
    # The upper left corner, and the steps right and down, in (x, y, z).
    for across, corner, right, down in (
        ("x", (2, 3, 0), (0, 0, 1), (0, -1, 0)),
        ("y", (0, 2, 0), (1, 0, 0), (0, 0, 1)),
        ("z", (0, 3, 2), (1, 0, 0), (0, -1, 0)),
    ):
        seen = cut(world, across, 2)
        assert tuple(seen[0, 0]) == corner
        assert tuple(seen[0, 1] - seen[0, 0]) == right
        assert tuple(seen[1, 0] - seen[0, 0]) == down


def test_fluence_and_direction_have_their_units():
    intensity = np.zeros((*SHAPE, 3, 4))
    intensity[..., 0] = 2.0
    intensity[1, 2, 3, :, 1] = 6.0  # b = 3a along +x: all light goes one way
    lattice = empty(intensity=intensity)
    np.testing.assert_allclose(lattice.fluence, 4.0 * np.pi * LOOKUP_SCALE * 2.0 / 0.25)
    np.testing.assert_allclose(lattice.direction[1, 2, 3], [1.0, 0.0, 0.0])
    assert not lattice.direction[0].any()


def test_texels_come_back_in_watts():
    red, green, blue = (np.full((*SHAPE, 4), k, np.float16) for k in (8.0, 4.0, 2.0))
    xy = np.zeros((*SHAPE, 4), np.uint8)
    xy[..., 3] = 255
    lattice = from_texels(red, green, blue, xy, np.full_like(xy, 51), power_scale=4.0, cell_m=1.0)
    np.testing.assert_allclose(lattice.intensity[0, 0, 0, :, 0], [2.0, 1.0, 0.5])
    np.testing.assert_allclose(lattice.openness[0, 0, 0], [0, 0, 0, 1, 0.2, 0.2])


@pytest.mark.parametrize(
    ("across", "hop", "side"),
    [
        ("z", 0, "left"),
        ("z", 1, "right"),
        ("z", 2, "lower"),
        ("z", 3, "upper"),
        ("y", 0, "left"),
        ("y", 1, "right"),
        ("y", 4, "upper"),
        ("y", 5, "lower"),
        ("x", 4, "left"),
        ("x", 5, "right"),
        ("x", 2, "lower"),
        ("x", 3, "upper"),
    ],
)
def test_a_wall_is_drawn_where_the_hop_would_come_in(across, hop, side):
    openness = np.ones((*SHAPE, 6))
    openness[1, 1, 1, hop] = 0.0
    image = slice_image(empty(openness=openness), across, 1, brightest=1.0, cell_px=16)
    is_wall = (np.abs(image.astype(int) - slices.WALL) <= 1).all(axis=-1)
    rows, columns = np.nonzero(is_wall)
    assert len(rows) == 2 * 16
    row = {"z": SHAPE[1] - 2, "y": 1, "x": SHAPE[1] - 2}[across]  # of cell (1, 1, 1)
    centre = (row * 16 + 7.5, 16 + 7.5)
    offset = np.array([columns.mean() - centre[1], centre[0] - rows.mean()])
    expected = {"left": (-7, 0), "right": (7, 0), "lower": (0, -7), "upper": (0, 7)}[side]
    np.testing.assert_allclose(offset, expected, atol=0.01)


def test_colour_is_stops_below_the_brightest():
    intensity = np.zeros((*SHAPE, 3, 4))
    intensity[1, 1, :, :, 0] = np.array([1.0, 0.5, 2.0**-4, 2.0**-8, 0.0])[:, None]
    lattice = empty(intensity=intensity)
    brightest = float(lattice.fluence.max())
    image = slice_image(lattice, "z", 1, brightest=brightest, cell_px=16)
    corners = image[2 * 16 + 1, 1::16].astype(int)  # away from the arrow's dot
    assert (np.diff(corners.sum(axis=-1)) <= 0).all()
    assert corners[0].sum() > 600
    assert (corners[3] == corners[4]).all()


def test_an_arrow_goes_where_the_light_goes():
    vectors = np.zeros((1, 3, 2))
    vectors[0, 0], vectors[0, 1] = (1.0, 0.0), (0.0, 1.0)
    cover = slices.arrows(vectors, 16)
    rows, columns = np.nonzero(cover[:, :16] > 0.3)
    assert columns.mean() > 9.0 and abs(rows.mean() - 7.5) < 0.1
    rows, columns = np.nonzero(cover[:, 16:32] > 0.3)
    assert rows.mean() < 6.0 and abs(columns.mean() - 7.5) < 0.1
    rows, columns = np.nonzero(cover[:, 32:] > 0.3)
    assert np.ptp(rows) <= 3 and np.ptp(columns) <= 3


def test_the_room_s_lattice_is_lit_inside_and_closed_by_walls(gpu):
    request = Request((32, 18), quick=True, adapter=gpu.info.name)
    lattice = clpv_debug.solved(request, {"resolution": 8})
    assert lattice.openness.shape[:3] == lattice.intensity.shape[:3]
    assert max(lattice.openness.shape[:3]) == 8
    assert np.isfinite(lattice.intensity).all()
    assert lattice.fluence.max() > 0.0
    assert 0.02 < float(np.mean(1.0 - lattice.openness)) < 0.6
    drawn = slice_image(lattice, "y", 3, brightest=1.0, cell_px=8)
    assert drawn.shape == (8 * lattice.openness.shape[0], 8 * lattice.openness.shape[2], 3)
