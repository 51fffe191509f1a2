"""When a scene gets a sun, a lamp, or is left alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene.camera import Camera
from airlight.scene.environment import Environment
from airlight.scene.io.defaults import with_default_camera, with_default_lights
from airlight.scene.lights import DirectionalLight, PointLight
from airlight.scene.material import Material
from airlight.scene.mesh import Geometry, Mesh
from airlight.scene.scene import Scene

GROUND = Geometry(
    np.array([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)], np.float32),
    np.array([(0, 1, 2), (0, 2, 3)]),
)


def shining(radiance: float) -> Scene:
    return Scene((Mesh(GROUND, Material(emission=(radiance, 0, 0))),))


def test_a_dark_scene_gets_a_sun_and_a_sky():
    scene = with_default_lights(Scene((Mesh(GROUND),)))
    (sun,) = scene.lights
    assert isinstance(sun, DirectionalLight)
    assert sun.direction[1] < -0.4
    assert scene.environment is not None
    assert scene.warnings == ()


def test_a_scene_that_shines_is_left_alone():
    for scene in (
        shining(17.0),
        replace(shining(0), lights=(PointLight((0, 1, 0), (1, 1, 1)),)),
        replace(shining(0), environment=Environment()),
    ):
        assert with_default_lights(scene) is scene


def test_a_dim_screen_is_no_lamp_and_that_is_said():
    scene = with_default_lights(shining(1.6))
    assert len(scene.lights) == 1
    assert scene.warnings == (
        "its emissive surfaces are dim (radiance 1.6): a default sun and sky were added",
    )


def closed_room() -> Scene:
    corners = np.array(np.meshgrid([0, 4], [0, 3], [0, 6], indexing="ij")).reshape(3, 8).T
    quads = [(0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (0, 2, 3, 1), (4, 5, 7, 6), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Scene((Mesh(Geometry(corners.astype(np.float32), np.array(triangles))),))


def test_a_closed_room_gets_a_lamp():
    scene = with_default_lights(closed_room())
    _, lamp = scene.lights
    assert isinstance(lamp, PointLight)
    assert lamp.position == pytest.approx((2, 2.55, 3), abs=0.01)
    below = lamp.intensity[0] / lamp.position[1] ** 2
    assert below == pytest.approx(10, rel=0.01)
    assert "a lamp was hung" in scene.warnings[0]


def test_the_camera_is_replaced():
    scene = with_default_camera(Scene((Mesh(GROUND),), camera=Camera((1, 1, 1), (9, 9, 9))))
    assert scene.camera.target == (0, 0, 0)
