"""What is read back of a view: distances along rays, layers that add up to the radiance."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from airlight.lighting.read_layers import NOT_ADDED
from airlight.rendering import Renderer
from airlight.scene import Camera, PointLight, Scene

CAMERA = Camera(position=(0.2, 1.5, 2.0), target=(0.0, 0.0, -1.0), fov_y_deg=60.0)
SIZE = (32, 24)


@pytest.fixture(scope="module")
def image(square):
    floor = square((-40, 0, 4), (80, 0, 0), (0, 0, -80))
    scene = Scene(meshes=(floor,), lights=(PointLight((0, 2, 0), (5, 4, 3)),), camera=CAMERA)
    with Renderer(scene, "lpv", SIZE) as renderer:
        return renderer.frame(samples=2)


def test_depth_is_the_distance_along_the_ray(square, camera_rays):
    floor = square((-40, 0, 4), (80, 0, 0), (0, 0, -80))
    with Renderer(Scene(meshes=(floor,), camera=CAMERA), "direct", SIZE) as renderer:
        depth = renderer.frame().layers["depth"]
    rays = camera_rays(CAMERA, SIZE)
    down = rays[..., 1] < 0.0
    wanted = -CAMERA.position[1] / np.where(down, rays[..., 1], -1.0)
    hits = np.array(CAMERA.position) + wanted[..., None] * rays
    on_floor = down & (np.abs(hits[..., 0]) < 40.0) & (hits[..., 2] > -76.0)
    assert 0 < on_floor.sum() < on_floor.size
    # Reversed depth in single precision: about 1e-7 of the distance over the near plane's. Far
    # away a pixel is metres of floor, and rasterisers may move vertices by 1/256 of one.
    snapped = np.abs(np.gradient(np.where(on_floor, wanted, np.nan), axis=0)) / 256
    most = 1e-4 * wanted + np.nan_to_num(snapped, nan=1.0)
    np.testing.assert_array_less(np.abs(depth - wanted)[on_floor], most[on_floor])
    assert np.isinf(depth[~on_floor]).all()


def test_layers_of_radiance_add_up(image):
    light = {"direct", "indirect", "single_scatter", "multiple_scatter", "emission", "background"}
    parts = [v for k, v in image.layers.items() if k in light and k not in NOT_ADDED]
    assert len(parts) >= 2
    np.testing.assert_allclose(np.sum(parts, axis=0), image.radiance, rtol=1e-5, atol=1e-6)


def test_depth_asked_for_late_is_that_of_its_own_frame(square):
    floor = square((-40, 0, 4), (80, 0, 0), (0, 0, -80))
    above = Camera(position=(0.0, 3.0, 0.0), target=(0.0, 0.0, -0.01), fov_y_deg=20.0)
    with Renderer(Scene(meshes=(floor,), camera=CAMERA), "direct", SIZE) as renderer:
        renderer.frame()
        first = renderer.frame(camera=above)
        renderer.frame(camera=CAMERA)
    np.testing.assert_allclose(np.median(first.layers["depth"]), 3.0, rtol=0.02)


def test_layers_survive_pickling(image):
    # As they do on the way from the workers of a farm.
    copied = pickle.loads(pickle.dumps(image))
    assert list(copied.layers) == list(image.layers)
    np.testing.assert_array_equal(copied.layers["depth"], image.layers["depth"])
