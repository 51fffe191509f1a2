"""Walls aslant to the cells part them: what surfaces cross, and what there is no way around."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.lattice.blockers import Blockers
from airlight.lattice.placement import Placement
from airlight.maths.parted_cells import parted
from airlight.scene import Material, Scene
from airlight.surface.geometry import GpuScene

N = 10
LATTICE = Placement((0.0, 0.0, 0.0), 0.5, (N, N, N))
COUNT = 20_000
MIDDLE = np.array([2.53, 2.47, 2.51])
Y = np.array([0.0, 1.0, 0.0])
PAINT, ONE_SIDED = Material(), Material(two_sided=False)


@pytest.fixture
def blocked(gpu, commands, owned):
    """blocked(mesh, ...) -> Blockers, encoded."""

    def solve(*meshes):
        scene = Scene(meshes=meshes)
        made = owned(Blockers(gpu, scene, owned(GpuScene(gpu, scene)), LATTICE, COUNT))
        made.encode(commands)
        commands.submit()
        return made

    return solve


def flags(buffer, first=0, step=1):
    """(3, Z, Y, X): the bits of each axis."""
    words = buffer.read(np.uint32).reshape(N, N, N)
    return np.stack([(words >> (first + step * axis)) & 1 for axis in range(3)]).astype(bool)


def board(square, degrees, half, material=PAINT):
    """Upright, turned about +Y; its front is where `along` turns to by a quarter."""
    a = np.radians(degrees)
    return square(MIDDLE, half * Y, half * np.array([np.sin(a), 0.0, np.cos(a)]), material)


def crossed_by_plane(degrees):
    """(3, Z, Y, X): the cells whose middles the plane of a board lies between."""
    a = np.radians(degrees)
    z, y, x = np.indices((N, N, N)) + 0.5
    at = np.stack([x, y, z], -1) * LATTICE.cell - MIDDLE
    before = at @ [np.cos(a), 0.0, -np.sin(a)] > 0.0
    found = np.zeros((3, N, N, N), bool)
    for axis in range(3):
        along = np.moveaxis(before, 2 - axis, 0)
        np.moveaxis(found[axis], 2 - axis, 0)[:-1] = along[1:] != along[:-1]
    return found


@pytest.mark.parametrize("degrees", [0, 17, 45])
def test_a_wall_aslant_is_a_staircase_without_a_gap(blocked, square, degrees):
    made = blocked(board(square, degrees, 6.0))
    expected = crossed_by_plane(degrees)
    assert not (expected & ~flags(made.crossed)).any()
    # and closes both ways
    for side in (0, 1):
        assert not (expected & ~flags(made.parted, side, 2)).any()
    closed = made.faces.read(np.uint32).reshape(N, N, N, 8)[..., :6] >> 24
    for axis in range(3):
        assert (closed[expected[axis]][:, 2 * axis] == 255).all()


def test_a_one_sided_wall_lets_light_come_from_behind(blocked, square):
    made = blocked(board(square, 30, 6.0, ONE_SIDED))
    expected = crossed_by_plane(30)
    up, down = (flags(made.parted, side, 2)[0][expected[0]] for side in (0, 1))
    assert up.all() != down.all()
    assert not (up & down).any()


@pytest.mark.parametrize("material", [Material(transmission=0.5), Material(alpha_cutoff=0.5)])
def test_what_light_passes_parts_nothing(blocked, square, material):
    assert not flags(blocked(board(square, 30, 6.0, material)).crossed).any()


def test_a_small_thing_parts_nothing(blocked, square):
    made = blocked(board(square, 30, 0.6))
    assert flags(made.crossed).any()
    assert not made.parted.read(np.uint32).any()


def test_parted_cells_are_their_twin(blocked, square):
    """A room's corner, a board and a hole: ways around some of it, and none around others."""
    walls = [board(square, 25, 6.0), board(square, 115, 2.0), board(square, 70, 1.1)]
    made = blocked(*walls)
    expected = parted(flags(made.crossed))
    assert 0 < expected.sum() < flags(made.crossed).sum()
    np.testing.assert_array_equal(flags(made.parted, 0, 2), expected)
    np.testing.assert_array_equal(flags(made.parted, 1, 2), expected)
