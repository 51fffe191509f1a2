"""Which axes a lattice takes: those of the walls, however these are cut, and else the world's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.lattice.facing import wall_axes
from airlight.lattice.placement import STRAIGHT
from airlight.scene import Geometry, Mesh, shapes


def turned(degrees, about=(0.0, 1.0, 0.0)):
    """(3, 3): a turn about a unit vector (Rodrigues)."""
    x, y, z = about
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    a = np.radians(degrees)
    return np.eye(3) + np.sin(a) * k + (1.0 - np.cos(a)) * k @ k


def box(size):
    """A box around the origin, of sides `size`."""
    unit = shapes.box()
    return Geometry((unit.positions * np.array(size)).astype(np.float32), unit.indices)


def placed(geometry, linear=None, at=(0.0, 0.0, 0.0)):
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) if linear is None else linear
    matrix[:3, 3] = at
    return Mesh(geometry, world_from_object=matrix)


def cut(geometry):
    """Every triangle in four."""
    a, b, c = (geometry.positions[geometry.indices[:, k]] for k in range(3))
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [np.stack(p, axis=1) for p in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    corners = np.concatenate(parts).reshape(-1, 3)
    return Geometry(corners, np.arange(len(corners), dtype=np.uint32).reshape(-1, 3))


@pytest.mark.parametrize("degrees", [-40.0, -3.0, 0.5, 12.0, 45.0])
def test_a_turned_room_turns_the_lattice(degrees):
    room = placed(box((8.0, 3.0, 5.0)), turned(degrees))
    axes = np.array(wall_axes((room,)))
    np.testing.assert_allclose(np.abs(axes @ turned(degrees)).max(axis=1), 1.0, atol=1e-7)
    assert axes[1].tolist() == [0.0, 1.0, 0.0]
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert np.diag(axes).min() >= np.cos(np.radians(45.0)) - 1e-6  # the names that are nearest


def test_a_tilted_room_turns_it_about_all_axes():
    matrix = turned(25.0, (0.6, 0.0, 0.8)) @ turned(20.0)
    axes = np.array(wall_axes((placed(box((8.0, 3.0, 5.0)), matrix),)))
    np.testing.assert_allclose(axes, matrix.T, atol=1e-6)


def test_furniture_aslant_does_not_turn_a_room():
    room = placed(box((8.0, 3.0, 5.0)))
    tables = [placed(box((1.0, 0.8, 0.6)), turned(10.0 * k), (k, 0.4, 0.0)) for k in range(1, 6)]
    assert wall_axes((room, *tables)) == STRAIGHT
    aslant = placed(box((8.0, 3.0, 5.0)), turned(30.0))
    axes = np.array(wall_axes((aslant, *tables)))
    np.testing.assert_allclose(axes, turned(30.0).T, atol=1e-7)


def test_what_faces_nowhere_in_particular_leaves_it_straight():
    assert wall_axes((placed(shapes.sphere()),)) == STRAIGHT
    assert wall_axes(()) == STRAIGHT
    flat = Geometry(np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.uint32))
    assert wall_axes((placed(flat),)) == STRAIGHT


def test_cuts_instances_and_sides_change_nothing():
    matrix = turned(17.0)
    whole = box((8.0, 3.0, 5.0))
    expected = np.array(wall_axes((placed(whole, matrix),)))
    flipped = replace(whole, indices=np.ascontiguousarray(whole.indices[:, ::-1]), normals=None)
    half = Geometry(whole.positions, whole.indices[::2])
    rest = Geometry(whole.positions, whole.indices[1::2])
    scaled = placed(box((1.0, 1.0, 1.0)), matrix @ np.diag([8.0, 3.0, 5.0]))
    for meshes in (
        (placed(cut(cut(whole)), matrix),),
        (placed(flipped, matrix),),
        (placed(half, matrix), placed(rest, matrix)),
        (scaled,),
    ):
        np.testing.assert_allclose(np.array(wall_axes(meshes)), expected, atol=1e-6)
