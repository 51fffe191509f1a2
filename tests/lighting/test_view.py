"""A camera's matrices."""

from __future__ import annotations

import numpy as np

from airlight.lighting.view import View
from airlight.scene import Camera


def test_pixels_see_what_the_camera_says(gpu, owned, camera_rays):
    view = owned(View(gpu, (8, 6)))
    camera = Camera(position=(1, 2, 3), target=(0, 1, -2), fov_y_deg=40.0)
    view.aim(camera)
    points = np.array(camera.position) + 3.7 * camera_rays(camera, (8, 6))
    clip = np.concatenate([points, np.ones((6, 8, 1))], axis=-1) @ view.clip_from_world.T
    ndc = clip[..., :2] / clip[..., 3:]
    x, y = np.meshgrid((np.arange(8) + 0.5) / 4 - 1, 1 - (np.arange(6) + 0.5) / 3)
    np.testing.assert_allclose(ndc, np.stack([x, y], axis=-1), atol=1e-9)
    np.testing.assert_allclose(view.world_from_clip @ view.clip_from_world, np.eye(4), atol=1e-9)
    assert view.eye == camera.position


def test_jitter_moves_the_image(gpu, owned):
    view = owned(View(gpu, (8, 6)))
    view.aim(Camera())
    still = view.clip_from_world
    view.aim(Camera(), (0.25, 0.5))
    ahead = np.array([0.0, 1.0, 0.0, 1.0])
    (a, b) = ((m @ ahead)[:2] / (m @ ahead)[3] for m in (still, view.clip_from_world))
    np.testing.assert_allclose((b - a) * [4, -3], [0.25, 0.5], atol=1e-9)


def test_memory_is_given_back(gpu):
    before = gpu.allocated_bytes
    scope = gpu.scope()
    view = View(scope, (8, 6))
    held = gpu.allocated_bytes
    view.resize((16, 12))
    assert gpu.allocated_bytes > held
    view.resize((8, 6))
    assert gpu.allocated_bytes == held > before
    scope.release()
    assert gpu.allocated_bytes == before
