"""Scene: bounds of what is in it."""

from __future__ import annotations

import numpy as np

from airlight.scene import Camera, Mesh, Scene, Volume
from airlight.scene.shapes import box, sphere


def test_bounds_hold_meshes_and_volumes():
    lifted = np.eye(4)
    lifted[1, 3] = 5.0
    smoke = Volume(sigma_t=1, shape="box", bounds=((2, 0, 0), (3, 1, 1)), world_from_volume=lifted)
    low, high = Scene(meshes=(Mesh(box()),), volumes=(smoke,)).bounds
    np.testing.assert_array_equal(low, [-0.5, -0.5, -0.5])
    np.testing.assert_array_equal(high, [3, 6, 1])


def test_an_empty_scene_is_around_its_camera():
    low, high = Scene(camera=Camera(position=(5, 5, 5), target=(0, 0, 0))).bounds
    np.testing.assert_array_equal([low, high], [[4, 4, 4], [6, 6, 6]])


def test_instances_count_each():
    shared = sphere(8, 4)
    scene = Scene(meshes=(Mesh(shared), Mesh(shared)))
    assert scene.triangle_count == 2 * len(shared.indices)
