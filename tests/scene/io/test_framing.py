"""Where the default camera stands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene.camera import Camera
from airlight.scene.io.defaults import with_default_camera
from airlight.scene.io.dense_part import air_beside
from airlight.scene.io.framing import find_room, framing_camera
from airlight.scene.io.obj import load_obj
from airlight.scene.io.outline import outline
from airlight.scene.io.probe import Probe
from airlight.scene.io.viewpoint import MARGIN, around
from airlight.scene.mesh import Geometry, Mesh
from airlight.scene.scene import Scene
from airlight.scene.shapes import box
from airlight.scene.volume import Volume


def quad(a, b, c, d) -> Mesh:
    return Mesh(Geometry(np.array([a, b, c, d], np.float32), np.array([(0, 1, 2), (0, 2, 3)])))


def room(x: float, y: float, z: float, *, open_front: bool = False, inward: bool = True) -> Scene:
    """A box from the origin to (x, y, z) whose fronts face inwards."""
    corners = np.array(np.meshgrid([0, x], [0, y], [0, z], indexing="ij")).reshape(3, 8).T
    faces = [(0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (0, 2, 3, 1), (4, 5, 7, 6), (1, 3, 7, 5)]
    kept = faces[:-1] if open_front else faces
    return Scene(tuple(quad(*corners[list(f if inward else f[::-1])]) for f in kept))


def in_image(camera: Camera, points: np.ndarray, aspect: float) -> np.ndarray:
    forward = np.subtract(camera.target, camera.position)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    right /= np.linalg.norm(right)
    offset = points - camera.position
    depth = offset @ forward
    half = np.tan(np.radians(camera.fov_y_deg) / 2) * depth
    up = np.cross(right, forward)
    return (depth > 0) & (abs(offset @ up) <= half) & (abs(offset @ right) <= half * aspect)


def test_a_room_is_found_and_seen_along_its_length_at_eye_height():
    probe = Probe.of(room(4, 3, 9))
    found = find_room(probe)
    assert found is not None
    np.testing.assert_allclose(found.low, 0, atol=0.01)
    np.testing.assert_allclose(found.high, [4, 3, 9], atol=0.01)
    camera = framing_camera(probe)
    assert camera.fov_y_deg == 60
    assert camera.position[1] == pytest.approx(1.6)
    look = np.subtract(camera.target, camera.position)
    assert abs(look[2]) > 4 * abs(look[0])
    assert min(camera.position[2], 9 - camera.position[2]) < 1.5


def test_a_hall_not_in_metres_is_seen_from_two_fifths_of_its_height():
    camera = framing_camera(Probe.of(room(400, 300, 900)))
    assert camera.position[1] == pytest.approx(120)


def test_an_open_box_is_seen_through_its_open_side():
    scene = room(2, 2, 2, open_front=True)
    camera = framing_camera(Probe.of(scene))
    assert camera.position[2] > 2
    assert camera.position[0] == pytest.approx(1)
    corners = np.concatenate([m.geometry.positions for m in scene.meshes])
    assert in_image(camera, corners, 4 / 3).all()


@pytest.mark.parametrize("size", [1e-3, 1.0, 500.0])
def test_a_thing_is_seen_whole_from_outside_and_fills_the_image(size):
    scene = room(size, size, 2 * size, inward=False)
    assert find_room(Probe.of(scene)) is None
    camera = framing_camera(Probe.of(scene))
    corners = np.concatenate([m.geometry.positions for m in scene.meshes]).astype(float)
    assert in_image(camera, corners, 4 / 3).all()
    closer = Camera(
        position=tuple(np.add(camera.position, camera.target) / 2),
        target=camera.target,
        fov_y_deg=camera.fov_y_deg,
    )
    assert not in_image(closer, corners, 4 / 3).all()


def test_the_teapot_is_no_room_and_the_living_room_is_one(shared_data):
    teapot = Probe.of(load_obj(shared_data / "teapot" / "teapot.obj"))
    assert find_room(teapot) is None
    living = Probe.of(load_obj(shared_data / "living_room" / "living_room.obj"))
    camera = framing_camera(living)
    # From the wall with the back light towards the windows, as in the image all know.
    assert camera.position[2] > 6.5
    assert camera.target[2] < 4
    assert -2.4 < camera.position[0] < 3
    assert camera.position[1] == pytest.approx(1.6, abs=0.05)


def test_nothing_to_frame():
    assert framing_camera(Probe.of(Scene())) == Camera()


def scaled(corners: np.ndarray, scale: float, shift=(0.0, 0.0, 0.0)) -> Camera:
    placed = scale * corners + np.array(shift)
    return framing_camera(Probe.of(Scene((quad(*placed),))))


UPRIGHT = np.array([(-1, 0, 0), (1, 0, 0), (1, 2, 0), (-1, 2, 0)], float)


def test_a_tiny_model_is_framed_as_its_large_likeness():
    usual = scaled(UPRIGHT, 1.0)
    for scale in (1e-5, 1e-3, 1e4):
        camera = scaled(UPRIGHT, scale)
        np.testing.assert_allclose(np.array(camera.position) / scale, usual.position, rtol=1e-3)
        assert in_image(camera, scale * UPRIGHT, 4 / 3).all()
    moved = scaled(UPRIGHT, 1.0, (5.0, -3.0, 2.0))
    np.testing.assert_allclose(np.subtract(moved.position, usual.position), (5, -3, 2), atol=2e-4)


def shape(x: float, y: float, z: float) -> tuple[Camera, np.ndarray]:
    camera = framing_camera(Probe.of(room(x, y, z, inward=False)))
    return camera, np.array(np.meshgrid([0, x], [0, y], [0, z])).reshape(3, 8).T


@pytest.mark.parametrize("size", [(1, 1, 1), (1, 9, 1), (6, 0.2, 5), (2, 3, 12), (8, 2, 0.1)])
def test_the_outline_lies_in_the_middle_with_a_margin(size):
    """The image that is bound by the outline: its border is MARGIN away on both sides."""
    camera, corners = shape(*size)
    towards = np.subtract(camera.position, camera.target)
    towards /= np.linalg.norm(towards)
    right = np.cross((0, 1, 0), towards)
    right /= np.linalg.norm(right)
    offset = corners - camera.position
    depth = -offset @ towards
    half = np.tan(np.radians(camera.fov_y_deg) / 2)
    x, y = offset @ right / depth / half, offset @ np.cross(towards, right) / depth / half
    for axis in (x, y):
        assert axis.max() == pytest.approx(-axis.min(), abs=2e-3)
    assert max(x.max() * 3 / 4, y.max()) == pytest.approx(1 / MARGIN, abs=2e-3)


def test_a_spike_that_points_at_the_eye_is_seen_from_beyond_it():
    direction = np.array((0.0, 0.0, 1.0))
    points = np.array([(0, 0, 10), (0.1, 0, -10), (-0.1, 0, -10), (0, 0.1, -10)], float)
    camera = around(direction, points)
    assert camera.position[2] > 10.0
    assert np.isfinite(camera.position).all()


def angles_deg(camera: Camera) -> tuple[float, float]:
    x, y, z = np.subtract(camera.position, camera.target)
    return np.degrees(np.arctan2(y, np.hypot(x, z))), np.degrees(np.arctan2(x, z))


def test_flat_things_are_seen_from_higher_and_long_ones_from_their_side():
    cube, column, slab, car = (
        angles_deg(shape(*size)[0]) for size in ((2, 2, 2), (1, 9, 1), (5, 0.1, 5), (2, 1.5, 6))
    )
    assert cube == pytest.approx(column, abs=0.1)
    assert slab[0] > cube[0] + 20.0 and slab[1] == pytest.approx(cube[1], abs=0.1)
    assert car[1] > cube[1] + 15.0
    # From the front, and never from below or behind.
    assert 0.0 < cube[0] < 30.0 and 20.0 < cube[1] < 45.0 and car[1] < 70.0


@pytest.mark.parametrize("turned", [False, True])
def test_smoke_beside_a_model_is_framed_with_it(turned):
    smoke = Volume(1.0, np.ones((4, 4, 4), np.float32), bounds=((5, 0, -1), (7, 2, 1)))
    if turned:
        smoke = replace(smoke, world_from_volume=np.diag([-1.0, 1.0, -1.0, 1.0]))
    scene = with_default_camera(Scene(meshes=(Mesh(box()),), volumes=(smoke,)))
    points = np.concatenate([outline(scene), air_beside(scene, outline(scene))])
    side = np.ptp(points[:, 0])
    assert side == pytest.approx(7.5, abs=0.1)
    # All of it is in an image of 4:3.
    assert in_image(scene.camera, points, 4 / 3).all()
