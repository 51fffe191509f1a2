"""When a scene gets a sun, a lamp, or is left alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.scene.camera import Camera
from airlight.scene.environment import Environment
from airlight.scene.io import load
from airlight.scene.io.defaults import LIGHT_RADIANCE, with_default_camera, with_default_lights
from airlight.scene.io.framing import framing_camera
from airlight.scene.io.probe import Probe
from airlight.scene.lights import DirectionalLight, PointLight
from airlight.scene.material import Material
from airlight.scene.mesh import Geometry, Mesh
from airlight.scene.scene import Scene
from airlight.scene.studio import NAME, incident_stops
from airlight.scene.volume import Volume

GROUND = Geometry(
    np.array([(-5, 0, -5), (-5, 0, 5), (5, 0, 5), (5, 0, -5)], np.float32),
    np.array([(0, 1, 2), (0, 2, 3)]),
)


def shining(radiance: float) -> Scene:
    return Scene((Mesh(GROUND, Material(emission=(radiance, 0, 0))),))


def test_a_dark_thing_gets_a_studio():
    scene = with_default_lights(Scene((Mesh(GROUND),)))
    (key,) = scene.lights
    assert isinstance(key, DirectionalLight)
    assert key.direction[1] < -0.4
    assert scene.environment is not None and scene.environment.source == NAME
    assert scene.warnings == ()


def test_a_dark_room_gets_a_sun_and_a_sky_and_is_metered():
    scene = with_default_lights(with_default_camera(closed_room()))
    assert scene.environment is not None and scene.environment.source == "default sky"
    assert scene.camera.exposure_stops is None


def test_air_alone_is_seen_before_the_sky_exposed_for_what_falls_on_it():
    smoke = Scene(volumes=(Volume(sigma_t=(1, 1, 1), shape="box", bounds=((0, 0, 0), (1, 2, 1))),))
    scene = with_default_lights(with_default_camera(smoke))
    assert scene.environment is not None and scene.environment.source == "default sky"
    towards_eye = np.subtract(scene.camera.position, scene.camera.target)
    stops = incident_stops(scene.lights[0], scene.environment, towards_eye)
    assert scene.camera.exposure_stops == stops


@pytest.mark.parametrize("turn_deg", [0.0, 70.0, 200.0])
def test_the_key_light_comes_over_the_left_shoulder(turn_deg):
    """Three quarters from the front as the camera sees it, whichever way that looks."""
    a = np.radians(turn_deg)
    eye = (5.0 * np.sin(a), 2.0, 5.0 * np.cos(a))
    scene = with_default_lights(Scene((Mesh(GROUND),), camera=Camera(eye, (0, 1, 0))))
    x, y, z = np.negative(scene.lights[0].direction)
    right, back = x * np.cos(a) - z * np.sin(a), x * np.sin(a) + z * np.cos(a)
    assert np.degrees(np.arctan2(right, back)) == pytest.approx(-43.0, abs=0.1)
    assert np.degrees(np.arcsin(y)) == pytest.approx(45.0)


def test_a_scene_that_shines_is_left_alone():
    for scene in (
        replace(shining(0), lights=(PointLight((0, 1, 0), (1, 1, 1)),)),
        replace(shining(0), environment=Environment()),
    ):
        assert with_default_lights(scene) is scene


def glowing_room() -> Scene:
    panel = Mesh(GROUND, Material(emission=(17, 17, 17)), place((2, 2.9, 3), 0.1))
    return Scene((*closed_room().meshes, panel))


def test_a_room_that_its_own_light_illuminates_is_left_alone():
    assert with_default_lights(scene := glowing_room()) is scene


def test_a_bare_model_with_a_glowing_part_is_seen_by_daylight():
    """As a lamp in the open: a person expects to see more than its bulb."""
    scene = with_default_lights(shining(17.0))
    assert len(scene.lights) == 1
    assert scene.warnings == ("its emissive surfaces light no room: a studio's light was added",)


@pytest.mark.parametrize("radiance", [0.01, 1.6, 17.0])
def test_whatever_emits_is_the_light_of_a_scene_file(radiance):
    scene = shining(radiance)
    kept = with_default_lights(scene, is_scene_file=True)
    assert kept.lights == ()
    assert kept.environment is None
    assert [w for w in kept.warnings if "dim" in w] == list(kept.warnings)
    assert bool(kept.warnings) == (radiance < LIGHT_RADIANCE)


def test_a_scene_file_that_glows_gets_no_sun(tmp_path):
    file = tmp_path / "glow.toml"
    file.write_text('[[mesh]]\nshape = "sphere"\nemission = 0.5\n', encoding="utf-8")
    scene = load(file)
    assert scene.lights == ()
    assert scene.environment is None


def test_a_camera_of_a_model_without_light_is_exposed_for_what_is_added(tmp_path):
    """Its exposure of 0 was for no light at all: under an added light it burns out."""
    camera = Camera((1, 1, 1), (0, 0, 0))
    added = with_default_lights(Scene((Mesh(GROUND),), camera=camera))
    stops = incident_stops(added.lights[0], added.environment, np.array((1.0, 1.0, 1.0)))
    assert stops < -2.0
    assert added.camera == replace(camera, exposure_stops=stops)
    chosen = replace(camera, exposure_stops=-2.0)
    bare = Scene((Mesh(GROUND),), camera=chosen)
    assert with_default_lights(bare).camera.exposure_stops == -2.0
    # The light stands for the camera, not for what it lights: a box has the ground's exposure.
    asked = {"": stops, "exposure_stops = 0": 0.0, "exposure_stops = 1": 1.0}
    for line, expected in asked.items():
        file = tmp_path / "dark.toml"
        file.write_text(
            f"[camera]\nposition = [1, 1, 1]\ntarget = [0, 0, 0]\n{line}\n"
            '[[mesh]]\nshape = "box"\n',
            encoding="utf-8",
        )
        assert load(file).camera.exposure_stops == expected


def test_a_camera_of_a_lit_model_keeps_its_exposure():
    lit = Scene((Mesh(GROUND),), lights=(PointLight((0, 1, 0), (1, 1, 1)),))
    assert with_default_lights(lit).camera.exposure_stops == 0.0


def place(at: tuple[float, float, float], size: float) -> np.ndarray:
    matrix = np.diag([size, size, size, 1.0])
    matrix[:3, 3] = at
    return matrix


def test_a_dim_screen_is_no_light_and_that_is_said():
    scene = with_default_lights(shining(1.6))
    assert len(scene.lights) == 1
    assert scene.warnings == (
        "its emissive surfaces are dim (radiance 1.6): a studio's light was added",
    )


def closed_room() -> Scene:
    corners = np.array(np.meshgrid([0, 4], [0, 3], [0, 6], indexing="ij")).reshape(3, 8).T
    quads = [(0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (0, 2, 3, 1), (4, 5, 7, 6), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return Scene((Mesh(Geometry(corners.astype(np.float32), np.array(triangles))),))


def test_a_closed_room_gets_a_light():
    scene = with_default_lights(closed_room())
    _, local_light = scene.lights
    assert isinstance(local_light, PointLight)
    assert local_light.position == pytest.approx((2, 2.55, 3), abs=0.01)
    below = local_light.intensity[0] / local_light.position[1] ** 2
    assert below == pytest.approx(10, rel=0.01)
    assert "a lamp was hung" in scene.warnings[0]


def test_a_camera_outside_a_closed_room_gets_no_light_in_it():
    scene = replace(closed_room(), camera=Camera((2, 1.5, 30), (2, 1.5, 3)))
    assert not any(isinstance(light, PointLight) for light in with_default_lights(scene).lights)


def test_the_camera_is_replaced():
    scene = Scene((Mesh(GROUND),), camera=Camera((1, 1, 1), (9, 9, 9)))
    framed = framing_camera(Probe.of(scene))
    assert with_default_camera(scene).camera == replace(framed, exposure_stops=None)
