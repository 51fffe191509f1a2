"""What views see of surfaces, layer by layer."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight.scene import Camera, DirectionalLight, Material, Scene
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.surfel_views import SurfelViews, camera_view

SIDE = 32
RED = Material(base_color=(0.8, 0.2, 0.1), specular=0.0)
GREY = Material(base_color=(0.5, 0.5, 0.5), specular=0.0)
DOWN = DirectionalLight((0, -1, 0), (1, 1, 1))


@pytest.fixture
def two_floors(gpu, owned, square):
    upper = square((0, 1, 0), (2, 0, 0), (0, 0, -2), RED)
    lower = square((0, -1, 0), (2, 0, 0), (0, 0, -2), GREY)
    scene = Scene(meshes=(upper, lower))
    return scene, owned(GpuScene(gpu, scene))


def test_the_second_layer_lies_behind_the_first(gpu, commands, owned, two_floors):
    scene, meshes = two_floors
    views = light_views([DOWN], *scene.bounds, SIDE)
    maps = owned(SurfelViews(gpu, SIDE, 1, 3))
    assert maps.encode(commands, meshes, views)
    commands.submit()
    inside = slice(4, -4)
    first, second, third = (maps.reflectance.read(k)[inside, inside, :3] / 255.0 for k in range(3))
    np.testing.assert_allclose(first, np.broadcast_to(RED.base_color, first.shape), atol=0.01)
    np.testing.assert_allclose(second, np.broadcast_to(GREY.base_color, first.shape), atol=0.01)
    assert not third.any()
    assert (maps.depth.read(1) >= maps.depth.read(0)).all()
    assert (maps.depth.read(2) == 1.0).all()
    np.testing.assert_allclose(maps.normal.read(0)[inside, inside, 1], 1.0, atol=1e-3)


def test_what_did_not_change_is_not_drawn_again(gpu, commands, owned, two_floors):
    scene, meshes = two_floors
    views = light_views([DOWN], *scene.bounds, SIDE)
    maps = owned(SurfelViews(gpu, SIDE, 1, 1))
    assert maps.encode(commands, meshes, views)
    assert not maps.encode(commands, meshes, views)
    upper, lower = scene.meshes
    higher = np.eye(4)
    higher[1, 3] = 0.1
    meshes.move((dataclasses.replace(upper, world_from_object=higher), lower))
    assert maps.encode(commands, meshes, views)
    commands.submit()


@pytest.mark.parametrize("aspect", [16 / 9, 0.5])
def test_a_cameras_square_view_holds_its_image(aspect):
    camera = Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), fov_y_deg=50.0)
    low, high = np.full(3, -10.0), np.full(3, 10.0)
    view = camera_view(camera, aspect, low, high, SIDE)
    half = np.tan(np.radians(25.0))
    corner = np.array([half * aspect * 5.0, half * 5.0, 0.0, 1.0])
    clip = view.clip_from_world @ corner
    assert (np.abs(clip[:2]) <= clip[3] * (1 + 1e-9)).all()
    assert max(np.abs(clip[:2])) == pytest.approx(clip[3])
