"""Skins and morph targets on their own: rigid bones move rigidly, normals stay at right angles."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from airlight.scene import Geometry, shapes
from airlight.scene.animation.skin import Morph, Shape, Skin, Vertices, skinned

RNG = np.random.default_rng(5)


def one_bone(count, joints=1):
    return Skin(
        joints=np.arange(joints),
        inverse_bind=np.tile(np.eye(4), (joints, 1, 1)),
        influences=RNG.integers(0, joints, (count, 4)),
        weights=np.full((count, 4), 0.25, np.float32),
    )


def placed(linear, offset=(0.0, 0.0, 0.0)):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, offset
    return matrix


def test_bones_that_agree_move_a_body_rigidly():
    ball = shapes.sphere()
    turn = Rotation.from_euler("xyz", (20, 50, -80), degrees=True).as_matrix()
    world = np.tile(placed(turn, (1, 2, 3)), (3, 1, 1))
    shape = Shape(Vertices(ball.positions, ball.normals), one_bone(len(ball.positions), 3))
    now = shape.deformed(np.zeros(0), world)
    np.testing.assert_allclose(now.positions, ball.positions @ turn.T + (1, 2, 3), atol=1e-5)
    np.testing.assert_allclose(now.normals, ball.normals @ turn.T, atol=1e-5)


def test_normals_stay_at_right_angles_under_uneven_scale_and_mirrors():
    ball = shapes.sphere()
    skin = one_bone(len(ball.positions))
    for linear in (np.diag([3.0, 0.5, 1.0]), np.diag([-1.0, 1.0, 1.0])):
        world = placed(linear)[None]
        now = skinned(Vertices(ball.positions, ball.normals), skin, skin.matrices(world))
        a, b, c = (now.positions[ball.indices[:, k]] for k in range(3))
        face = np.cross(b - a, c - a) * np.sign(np.linalg.det(linear))
        length = np.linalg.norm(face, axis=1)
        large = length > 0.1 * length.max()
        agree = np.einsum("tk,tk->t", face / length[:, None], now.normals[ball.indices[:, 0]])
        assert agree[large].min() > 0.9


def test_without_normals_they_come_from_the_faces():
    quad = shapes.quad()
    lift = np.zeros((1, len(quad.positions), 3), np.float32)
    lift[0, quad.positions[:, 0] > 0, 1] = 1.0
    shape = Shape(Vertices(quad.positions), morph=Morph(lift))
    now = shape.deformed(np.array([1.0]), np.zeros((0, 4, 4)))
    assert now.normals is None
    sloped = Geometry(now.positions, quad.indices).normals
    np.testing.assert_allclose(sloped, np.tile([-(0.5**0.5), 0.5**0.5, 0], (4, 1)), atol=1e-6)


def test_tangents_go_with_the_surface_and_bitangents_with_its_mirrors():
    """Of a square in z = 0 the image's axes are the first two columns of any matrix."""
    square = np.zeros((4, 3), np.float32)
    at_rest = Vertices(
        square, np.tile(np.float32((0, 0, 1)), (4, 1)), np.float32([(1, 0, 0, 1)] * 4)
    )
    skin = one_bone(4)
    for linear in (np.diag([3.0, 0.5, 1.0]), np.diag([-1.0, 1.0, 1.0]), np.diag([1.0, 1.0, -2.0])):
        now = skinned(at_rest, skin, skin.matrices(placed(linear)[None]))
        tangent, side = now.tangents[0, :3], now.tangents[0, 3]
        np.testing.assert_allclose(tangent, linear[:, 0])
        bitangent = side * np.cross(now.normals[0], tangent)
        np.testing.assert_allclose(bitangent / np.linalg.norm(bitangent), (0, 1, 0), atol=1e-6)


def test_morph_targets_turn_tangents_and_keep_their_side():
    flat = Vertices(np.zeros((1, 3), np.float32), None, np.float32([(1, 0, 0, -1)]))
    deltas = np.float32([[(-1, 1, 0)]])
    shape = Shape(flat, morph=Morph(np.zeros((1, 1, 3), np.float32), None, deltas))
    for weight in (0.0, 0.25, 1.0):
        now = shape.deformed(np.array([weight]), np.zeros((0, 4, 4)))
        np.testing.assert_allclose(now.tangents, [(1 - weight, weight, 0, -1)], atol=1e-7)
