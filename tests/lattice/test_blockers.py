"""Which cell faces surfaces close, on which side, and where the walls really are."""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np
import pytest

from airlight.lattice.blockers import Blockers
from airlight.lattice.placement import Placement
from airlight.scene import Material, Scene
from airlight.surface.geometry import GpuScene

N, CELL = 8, 0.5
ROOM = Placement((0.0, 0.0, 0.0), CELL, (N, N, N))
COUNT = 20_000
PAINT = Material(base_color=(0.8, 0.4, 0.2), specular=0.0)


@pytest.fixture
def blocked(encoded_blockers):
    """blocked(mesh, ...) -> Blockers, encoded."""
    return partial(encoded_blockers, ROOM, COUNT)


def closed(blockers):
    """(6, Z, Y, X): the closed share of each outgoing hop."""
    words = blockers.faces.read(np.uint32).reshape(N, N, N, 8)
    return np.moveaxis(words[..., :6] >> 24, -1, 0) / 255.0


def entering(blockers):
    """(6, Z, Y, X): the open share of each incoming hop."""
    octets = blockers.face_visibility.read(np.uint8).reshape(N, N, N, 8)
    return np.moveaxis(octets[..., :6], -1, 0) / 255.0


def wall(square, x, material=PAINT):
    """A wall in the plane x (metres), facing +x, beyond the lattice on all sides."""
    return square((x, 2, 2), (0, 3, 0), (0, 0, 3), material)


def test_a_full_wall_closes_its_faces_and_no_others(blocked, square):
    made = blocked(wall(square, 4 * CELL))
    expected = np.zeros((6, N, N, N))
    expected[0, :, :, 3] = 1.0  # leaving cell 3 along +x
    expected[1, :, :, 4] = 1.0  # leaving cell 4 along -x
    np.testing.assert_array_equal(closed(made), expected)
    arriving = np.ones((6, N, N, N))
    arriving[0, :, :, 4] = 0.0
    arriving[1, :, :, 3] = 0.0
    np.testing.assert_array_equal(entering(made), arriving)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_one_sided_wall_stops_what_it_faces(blocked, square, axis):
    u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
    centre = np.full(3, 2.0)
    mesh = square(centre, 3 * u, 3 * v, Material(two_sided=False))  # faces +axis
    shares = closed(blocked(mesh))
    along = np.moveaxis(shares, 3 - axis, 1)  # (6, along the axis, ., .)
    expected = np.zeros_like(along)
    expected[2 * axis + 1, 4] = 1.0  # light that travels along -axis
    np.testing.assert_array_equal(along, expected)


def test_textures_say_the_same_as_the_buffer(blocked, square):
    made = blocked(wall(square, 4 * CELL))
    octets = np.concatenate([made.visibility_a.read(), made.visibility_b.read()], axis=-1)
    stored = made.face_visibility.read(np.uint8).reshape(N, N, N, 8)
    np.testing.assert_array_equal(octets[..., :6], stored[..., :6])
    # and the low faces across x and y once more, for rays
    np.testing.assert_array_equal(octets[..., 6:], stored[..., 0:4:2])


def test_closed_faces_reflect_the_colour_of_what_closes_them(blocked, square):
    words = blocked(wall(square, 4 * CELL)).faces.read(np.uint32).reshape(N, N, N, 8)
    rgb = [(words[2, 3, 3, 0] >> shift) & 255 for shift in (0, 8, 16)]
    np.testing.assert_allclose(np.array(rgb) / 255.0, PAINT.base_color, atol=1 / 255)


def test_a_hole_stays_open(blocked, square):
    # The hole is cells 2 to 5; its rim is shared with the wall.
    x, low, high = 4 * CELL, 2 * CELL, 6 * CELL
    above = square((x, (high + 5) / 2, 2), (0, (5 - high) / 2, 0), (0, 0, 3), PAINT)
    below = square((x, (low - 1) / 2, 2), (0, (low + 1) / 2, 0), (0, 0, 3), PAINT)
    left = square((x, 2, (low - 1) / 2), (0, (high - low) / 2, 0), (0, 0, (low + 1) / 2), PAINT)
    right = square((x, 2, (high + 5) / 2), (0, (high - low) / 2, 0), (0, 0, (5 - high) / 2), PAINT)
    share = closed(blocked(above, below, left, right))[0, :, :, 3]
    np.testing.assert_array_equal(share[3:5, 3:5], 0.0)
    outer = np.ones((N, N), bool)
    outer[1:7, 1:7] = False
    np.testing.assert_array_equal(share[outer], 1.0)
    rim = share[2, 3:5]
    assert ((rim > 0.1) & (rim < 0.9)).all()


@pytest.mark.parametrize("fraction", [0.1, 0.3, 0.7, 0.9])
def test_a_wall_inside_a_cell_is_closed_at_a_face_and_its_place_is_kept(blocked, square, fraction):
    made = blocked(wall(square, (4 + fraction) * CELL))
    face = 4 if fraction < 0.5 else 5
    shares = closed(made)
    np.testing.assert_array_equal(shares[0, :, :, face - 1], 1.0)
    np.testing.assert_array_equal(shares[1, :, :, face], 1.0)
    assert shares.sum() == 2 * N * N
    shift = made.walls.read()[..., :3] / 127.0
    np.testing.assert_allclose(shift[:, :, face, 0], 4 + fraction - face, atol=0.01)
    shift[:, :, face, 0] = 0.0
    assert not shift.any()


def enclosed_faces(blockers):
    """(6, Z, Y, X): whether each outgoing hop ends at a wall with air before it."""
    bits = blockers.walls.read()[..., 3]
    return np.stack([(bits >> hop) & 1 for hop in range(6)])


@pytest.mark.parametrize("gap", [None, 0.3, 0.05])
def test_a_floor_is_an_enclosed_face_for_what_hangs_over_it(blocked, square, gap):
    one_sided = Material(two_sided=False)
    floor = square((4 * CELL, 2, 2), (0, 3, 0), (0, 0, 3), one_sided)  # faces +x
    over = (
        []
        if gap is None
        else [
            square(((4 + gap) * CELL, 2, 2), (0, 0, 3), (0, 3, 0), one_sided)  # faces -x
        ]
    )
    expected = np.zeros((6, N, N, N), int)
    expected[1, :, :, 4] = 1  # leaving cell 4 along -x
    if gap is not None:
        expected[0, :, :, 3] = 1  # and what is over it, from below the floor
    np.testing.assert_array_equal(enclosed_faces(blocked(floor, *over)), expected)


def test_a_board_is_an_enclosed_face_from_both_its_sides(blocked, square):
    one_sided = Material(two_sided=False)
    front = square((4.1 * CELL, 2, 2), (0, 3, 0), (0, 0, 3), one_sided)  # faces +x
    back = square((3.9 * CELL, 2, 2), (0, 0, 3), (0, 3, 0), one_sided)
    expected = np.zeros((6, N, N, N), int)
    expected[0, :, :, 3] = expected[1, :, :, 4] = 1
    np.testing.assert_array_equal(enclosed_faces(blocked(front, back)), expected)


def test_what_stands_on_a_floor_leaves_it_an_enclosed_face(blocked, square):
    # A pot on it (its underside, its top) and a leaf: closed things and sheets cancel out.
    one_sided = Material(two_sided=False)
    spread = (0, 3, 0), (0, 0, 3)
    floor = square((4 * CELL, 2, 2), *spread, one_sided)
    under = square((4 * CELL, 2, 2), *spread[::-1], one_sided)
    top = square((4.3 * CELL, 2, 2), *spread, one_sided)
    leaf = square((4.4 * CELL, 2, 2), *spread, Material(two_sided=True))
    ends = enclosed_faces(blocked(floor, under, top, leaf))
    assert ends[1, :, :, 4].all()
    assert not ends[0].any()


def test_a_sheet_is_no_enclosed_face(blocked, square):
    assert not enclosed_faces(blocked(wall(square, 4 * CELL))).any()


def test_little_area_bends_nothing(blocked, square):
    # 1% of a face, off its plane
    made = blocked(square((4.3 * CELL, 2, 2), (0, 0.025, 0), (0, 0, 0.025)))
    assert not made.walls.read().any()


def test_blockers_follow_the_geometry_and_are_made_once(gpu, commands, owned, square):
    mesh = wall(square, 4 * CELL)
    scene = Scene(meshes=(mesh,))
    on_device = owned(GpuScene(gpu, scene))
    made = owned(Blockers(gpu, scene, on_device, ROOM, COUNT))
    other = owned(Blockers(gpu, scene, on_device, ROOM, COUNT))
    assert made.encode(commands)
    assert not made.encode(commands)
    assert (made.version, other.version) == (1, 0)
    moved = np.eye(4)
    moved[0, 3] = -2 * CELL
    on_device.move((dataclasses.replace(mesh, world_from_object=moved),))
    assert made.encode(commands)
    assert (made.version, other.version) == (2, 0)
    commands.submit()
    assert np.nonzero(closed(made)[0].sum(axis=(0, 1)))[0].tolist() == [1]


def test_memory_is_given_back(gpu, owned, square):
    scene = Scene(meshes=(wall(square, 1.0),))
    on_device = owned(GpuScene(gpu, scene))
    before = gpu.allocated_bytes
    scope = gpu.scope()
    made = Blockers(scope, scene, on_device, ROOM, 100)
    assert gpu.allocated_bytes > before
    scope.release()
    assert gpu.allocated_bytes == before
    assert made.surfels.handle is None
