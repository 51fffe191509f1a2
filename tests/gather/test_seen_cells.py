"""Which cells of lattices a view reads: all that its rays do, and few others."""

from __future__ import annotations

import numpy as np
import pytest
from tests.gather.test_solver import LPV, X, Z, rectangle

from airlight.gather import batches
from airlight.gather.seen_cells import (
    MOST,
    NO_POINT,
    TURNS,
    SeenCells,
    numbers_of_points,
    seen_cells,
)
from airlight.lattice.placement import Fade, Placement
from airlight.rendering import render
from airlight.scene import Camera, DirectionalLight, Material, Medium, Scene

TURNED = ((0.8, 0.0, 0.6), (0.0, 1.0, 0.0), (-0.6, 0.0, 0.8))
COARSE = Placement((-8.0, -4.0, -8.0), 1.0, (16, 8, 16), axes=TURNED)
FINE = Placement(
    (-4.0, -4.0, -4.0),
    0.5,
    (16, 16, 16),
    fade=Fade((-4.0,) * 3, (0.5,) * 3, (4.0,) * 3, (0.5,) * 3),
    axes=TURNED,
)
CAMERA = Camera((2.0, 0.5, 3.0), (-1.0, 0.0, -1.0), fov_y_deg=40.0)


def points_in_view(camera, count):
    """Points (count, 3) along rays of a view twice as wide as high."""
    rng = np.random.default_rng(5)
    forward = np.subtract(camera.target, camera.position)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 1.0, 0.0))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    half = np.tan(np.radians(0.5 * camera.fov_y_deg))
    u, v = rng.uniform(-1.0, 1.0, (2, count, 1))
    depth = rng.uniform(0.0, 16.0, (count, 1))
    return np.array(camera.position) + depth * (forward + half * (2.0 * u * right + v * up))


def test_all_cells_that_rays_of_the_view_read_are_among_them():
    """Rays read the eight cells around a point of every lattice that counts there."""
    seen = seen_cells((FINE, COARSE), CAMERA, (20, 10), (0.0, 0.0), 0)
    is_seen = np.zeros(FINE.cells + COARSE.cells, bool)
    is_seen[seen.cells] = True
    points = points_in_view(CAMERA, 20_000) @ np.array(TURNED).T
    low, high = FINE.bounds
    covered = ((points > low + 0.5) & (points < high - 0.5)).all(axis=1)
    for placement, first, at in ((FINE, 0, points), (COARSE, FINE.cells, points[~covered])):
        low, high = placement.bounds
        inside = at[((at > low) & (at < high)).all(axis=1)]
        assert len(inside) > 1000
        lower = np.floor((inside - low) / placement.cell - 0.5).astype(int)
        for step in np.ndindex(2, 2, 2):
            x, y, z = np.clip(lower + step, 0, np.array(placement.count) - 1).T
            number = (z * placement.count[1] + y) * placement.count[0] + x
            assert is_seen[first + number].all()
    # READ cells around those and turns are much of so few.
    assert is_seen.mean() < 0.7


@pytest.mark.parametrize("each", [1, 3])
def test_points_are_the_places_in_the_list(each):
    seen = seen_cells((FINE, COARSE), CAMERA, (20, 10), (0.0, 0.0), 0, each)
    count = FINE.cells + COARSE.cells
    first, number = seen.points(count).T
    sends = first != NO_POINT
    np.testing.assert_array_equal(np.flatnonzero(sends), np.unique(seen.cells))
    assert not number[~sends].any() and number.sum() == seen.cells.size
    # The points of a cell follow one another.
    for k in range(int(number.max())):
        has = sends & (number > k)
        np.testing.assert_array_equal(seen.cells[first[has] + k], np.flatnonzero(has))
    assert number.max() == 1 if each == 1 else number.max() > 8
    (first, begin), (other, middle) = seen.firsts
    assert (first, begin, other) == (0, 0, FINE.cells)
    assert (seen.cells[:middle] < FINE.cells).all()
    assert (seen.cells[middle:] >= FINE.cells).all()


def test_points_are_shared_by_solid_angles_and_are_no_more_than_asked():
    angles = np.random.default_rng(2).uniform(0.0, 1.0, 5000) ** 8
    numbers = numbers_of_points(angles, 4)
    assert numbers.min() == 1 and 0.8 * 4 * angles.size < numbers.sum() <= 4 * angles.size
    others = numbers - 1
    large = others > 10
    shares = others[large] / angles[large]
    assert large.sum() > 100 and shares.max() < 1.1 * shares.min()
    assert (numbers_of_points(angles, 1) == 1).all()
    assert numbers_of_points(np.array([1.0, 1e-9, 1e-9]), 100).tolist() == [MOST, 1, 1]


def test_near_cells_have_most_points():
    seen = seen_cells((FINE,), CAMERA, (20, 10), (0.0, 0.0), 0, 2)
    number = seen.points(FINE.cells)[:, 1]
    z, y, x = np.indices(FINE.count[::-1]).reshape(3, -1)
    middles = np.array(FINE.origin) + FINE.cell * (np.stack([x, y, z], axis=1) + 0.5)
    off = np.linalg.norm(middles - np.array(TURNED) @ CAMERA.position, axis=1)
    assert number[off < 1.0].max() == number.max()
    assert number[(off > 4.0) & (number > 0)].max() <= 2


def test_cells_out_of_sight_have_their_turn():
    """All of them within TURNS samples, as many in each; those in sight keep their points."""
    turns = [
        seen_cells((FINE, COARSE), CAMERA, (20, 10), (0.0, 0.0), turn) for turn in range(TURNS)
    ]
    assert len({turn.cells.size for turn in turns}) == len({turn.firsts for turn in turns}) == 1
    every = np.unique(np.concatenate([turn.cells for turn in turns]))
    # All but those of the coarser lattice that are read where the finer one has all light.
    side = COARSE.origin[0] + COARSE.cell * (np.arange(16) + 0.5)
    is_between = (side > -3.5 + 2.0) & (side < 3.5 - 2.0)
    covered = is_between.sum() ** 2 * is_between[4:12].sum()
    assert every.size == FINE.cells + COARSE.cells - covered
    # Each has rays in a part of the samples, or in all: those hold on to their places.
    is_same = turns[0].cells == turns[1].cells
    seen = turns[0].cells[is_same]
    for turn in turns[2:]:
        np.testing.assert_array_equal(turn.cells[is_same], seen)
    assert turns[0].cells.size < 0.7 * every.size


def test_a_view_that_sees_nothing_has_turns_alone():
    away = Camera((0.0, 0.0, 20.0), (0.0, 0.0, 40.0), fov_y_deg=40.0)
    assert seen_cells((COARSE,), away, (8, 8), (0.0, 0.0), 3).cells.size == COARSE.cells / TURNS


def every_cell(placements, camera, size, shift_px, turn, each):
    counts = [placement.cells for placement in placements]
    firsts = [sum(counts[:k]) for k in range(len(counts))]
    return SeenCells(
        np.arange(sum(counts), dtype=np.uint32), tuple(zip(firsts, firsts, strict=True))
    )


@pytest.mark.parametrize("away", [0.0, 30.0])
def test_the_image_is_as_if_all_cells_sent_rays(monkeypatch, away):
    """Fog between a lit floor and a dark one; the camera sees a corner of it, or none."""
    floor = rectangle(-2 * X - 2 * Z, 4 * X, 4 * Z, Material(base_color=(0.8,) * 3, specular=0.0))
    air = Medium((0.2,) * 3, (1.0,) * 3, bounds=((-2.0, 0.0, -2.0), (2.0, 3.0, 2.0)))
    camera = Camera((-1.5, 1.5 + away, 1.5), (-2.0, 0.5 + away, -2.0), fov_y_deg=40.0)
    sun = DirectionalLight((0.3, -1, 0), (np.pi,) * 3)
    scene = Scene((floor,), (sun,), camera=camera, medium=air)
    settings = {**LPV, "iterations": 8, "resolution": 12, "march_resolution": "full"}

    def scattered():
        return render(scene, "lpv-scatter", (16, 12), samples=8, settings=settings).layers[
            "multiple_scatter"
        ]

    # Turns begin in the middle of the image's samples.
    monkeypatch.setattr(batches, "FIRST", 4)
    few = scattered()
    monkeypatch.setattr(batches, "seen_cells", every_cell)
    all_of_them = scattered()
    np.testing.assert_allclose(few.mean(), all_of_them.mean(), rtol=0.02)
    # 64 rays of each cell in sight: their noise.
    assert np.linalg.norm(few - all_of_them) <= 0.05 * np.linalg.norm(all_of_them)
