"""Rigs: what hangs on nodes moves with them, in the file's place of the world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene import Camera, Mesh, PointLight, Scene, SpotLight, shapes
from airlight.scene.animation.curve import Curve
from airlight.scene.animation.rig import Clip, Part, Rig, Skeleton
from airlight.scene.animation.tracks import Placing
from airlight.scene.placing import moved_camera

UP_2 = np.eye(4)
UP_2[1, 3] = 2.0


def two_nodes():
    """Node 1 hangs 2 m above node 0; node 0 goes 4 m along x in 2 s."""
    skeleton = Skeleton(
        order=((0, -1), (1, 0)),
        translation=np.zeros((2, 3)),
        rotation=np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)),
        scale=np.ones((2, 3)),
        matrix={1: UP_2},
    )
    path = Curve(np.array([0.0, 2.0]), np.array([[0, 0, 0], [4, 0, 0]]), "linear")
    clip = Clip("go", {(0, "translation"): path}, {})
    return Rig(skeleton, (Part(1),), ((1, PointLight((0, 0, 1), (1, 1, 1))),), clips=(clip,))


def scene():
    return Scene(meshes=(Mesh(shapes.box()),), lights=(PointLight((9, 9, 9), (1, 1, 1)),))


def test_meshes_and_lights_go_with_their_nodes():
    at = two_nodes().apply(scene(), 1.0)
    np.testing.assert_allclose(at.meshes[0].world_from_object[:3, 3], [2, 2, 0])
    assert at.lights[0] == PointLight((2, 2, 1), (1, 1, 1))
    assert at.camera == Camera()
    rest = two_nodes().at_rest(scene())
    np.testing.assert_allclose(rest.meshes[0].world_from_object, UP_2)


def test_clips_start_run_faster_and_go_round():
    rig = replace(two_nodes(), start_s=1.0, speed=4.0)
    assert rig.end_s == 1.5
    assert [rig.apply(scene(), t).lights[0].position[0] for t in (0.5, 1.25, 3.0)] == [0, 2, 4]
    looped = replace(rig, is_loop=True)
    assert looped.end_s == float("inf")
    assert looped.apply(scene(), 1.75).lights[0].position[0] == 2.0
    assert replace(rig, clips=()).end_s == 0.0


def test_the_files_place_may_move_too():
    lift = Curve(np.array([0.0, 1.0]), np.array([[0, 0, 0], [0, 10, 0]]), "linear")
    rig = replace(two_nodes(), world_from_file=Placing({"translate": lift}, {"scale": (2, 2, 2)}))
    at = rig.apply(scene(), 0.5)
    np.testing.assert_allclose(at.meshes[0].world_from_object[:3, 3], [2, 4 + 5, 0])
    assert at.lights[0].position == (2, 9, 2)


def test_the_files_camera_keeps_the_scenes_exposure():
    rig = replace(two_nodes(), camera=(1, Camera((0, 0, 0), (0, 0, -1), fov_y_deg=30.0)))
    start = replace(scene(), camera=Camera(exposure_stops=-2.0))
    assert rig.apply(start, 2.0).camera == Camera(
        (4, 2, 0), (4, 2, -1), fov_y_deg=30.0, exposure_stops=-2.0
    )


def test_lights_and_cameras_through_a_matrix():
    quarter = np.eye(4)
    quarter[:3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]  # about +Y: +X to -Z
    quarter[:3, 3] = (0, 1, 0)
    spot = SpotLight((1, 0, 0), (1, 0, 0), (2, 2, 2), 10, 20).moved(quarter)
    assert spot.position == (0, 1, -1) and spot.inner_deg == 10
    assert spot.direction == pytest.approx((0, 0, -1))
    seen = moved_camera(Camera((1, 0, 0), (2, 0, 0), fov_y_deg=33.0), quarter)
    assert (seen.position, seen.target, seen.fov_y_deg) == ((0, 1, -1), (0, 1, -2), 33.0)
