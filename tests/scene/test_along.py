"""Boxes along axes: tight around what is turned, over all of an animation's time."""

from __future__ import annotations

import numpy as np

from airlight.scene import Mesh, Scene, Volume, shapes
from airlight.scene.along import bounds_along, meshes_along, whole_bounds_along
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.tracks import MeshTrack, Placing

C, S = 0.8, 0.6
AXES = np.array([[C, 0.0, -S], [0.0, 1.0, 0.0], [S, 0.0, C]])


def turned(geometry, size):
    matrix = np.eye(4)
    matrix[:3, :3] = AXES.T * size
    matrix[:3, 3] = (1.0, 2.0, 3.0)
    return Mesh(geometry, world_from_object=matrix)


def test_a_turned_box_is_itself_along_its_axes():
    low, high = bounds_along(Scene((turned(shapes.box(), (4.0, 2.0, 1.0)),)), AXES)
    np.testing.assert_allclose(high - low, [4.0, 2.0, 1.0], atol=1e-6)
    np.testing.assert_allclose(0.5 * (low + high), AXES @ [1.0, 2.0, 3.0], atol=1e-6)


def test_what_is_turned_has_a_tight_box_of_the_world():
    ball = Scene((turned(shapes.sphere(), (2.0, 2.0, 2.0)),))
    low, high = bounds_along(ball, np.eye(3))
    np.testing.assert_allclose([low, high], [[0.0, 1.0, 2.0], [2.0, 3.0, 4.0]], atol=0.02)
    looser = np.subtract(*ball.bounds[::-1]).max()
    assert np.max(high - low) < 0.75 * looser  # the box of its own turned box


def test_volumes_count_and_emptiness_is_a_box_around_the_camera():
    volume = Volume(sigma_t=1.0, shape="box", bounds=((0, 0, 0), (1, 1, 1)))
    low, high = bounds_along(Scene(volumes=(volume,)), AXES)
    np.testing.assert_allclose(high - low, [C + S, 1.0, C + S])
    assert meshes_along((), AXES) is None
    low, high = bounds_along(Scene(), AXES)
    assert (high > low).all()


def test_an_animation_counts_with_all_its_time():
    away = Curve(np.array([0.0, 1.0]), np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), "linear")
    track = MeshTrack(0, np.eye(4)[None], Placing({"translate": away}, {}))
    moving = Animation((track,), end_s=1.0)
    scene = Scene((Mesh(shapes.box()),), animation=moving)
    low, high = whole_bounds_along(scene, AXES)
    np.testing.assert_allclose(high - low, [3.0 * C + C + S, 1.0, 3.0 * S + C + S], atol=0.05)
