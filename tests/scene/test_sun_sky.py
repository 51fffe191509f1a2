"""A sky by angles, by place and time, and by text; a scene under it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.maths.latlong import latlong_texel_directions
from airlight.rendering import render
from airlight.scene import Camera, DirectionalLight, Environment, PointLight, Scene
from airlight.scene.io import load
from airlight.scene.sun_sky import Sky, followed, sky_of_text, with_sky


def test_the_sun_is_where_its_angles_say_and_the_glow_around_it():
    sky = Sky(elevation_deg=30.0, azimuth_deg=90.0)
    assert sky.towards_sun == pytest.approx((np.sqrt(0.75), 0.5, 0.0))
    made = sky.map()
    row, column = np.unravel_index(made.sum(axis=2).argmax(), made.shape[:2])
    brightest = latlong_texel_directions(*made.shape[:2])[row, column]
    assert float(brightest @ sky.towards_sun) > np.cos(np.radians(2.0))
    assert made.shape == (256, 512, 3)


def test_text_of_angles_and_of_time_and_place():
    assert sky_of_text("35,135") == Sky(35.0, 135.0)
    assert sky_of_text(" 35 , 135 , 4 ").turbidity == 4.0
    munich = sky_of_text("2026-06-21T13:14+02:00@48.1,11.6")  # its noon
    assert munich.elevation_deg == pytest.approx(90.0 - 48.1 + 23.43, abs=0.05)
    assert munich.azimuth_deg == pytest.approx(180.0, abs=1.0)
    # Without an offset the clock is the longitude's own.
    assert sky_of_text("2026-06-21T12:14@48.1,11.6") == munich


@pytest.mark.parametrize(
    "text", ["noon", "35", "95,0", "35,135,0.5", "35,135,4,1", "tomorrow@48,11", "nan,3", "1,@"]
)
def test_other_text_is_refused_in_one_sentence(text):
    with pytest.raises(SceneError) as caught:
        sky_of_text(text)
    assert "\n" not in str(caught.value)


def test_night_is_refused():
    with pytest.raises(SceneError, match="it is night"):
        sky_of_text("2026-12-21T00:00@48.1,11.6")


def test_it_replaces_directional_lights_and_keeps_local_ones():
    local_light = PointLight((0.0, 1.0, 0.0), (1.0, 1.0, 1.0))
    old = DirectionalLight((0.0, -1.0, 0.0), (3.0, 3.0, 3.0))
    scene = with_sky(Scene(lights=(old, local_light), environment=Environment()), Sky(40.0, 10.0))
    assert scene.lights[0] is local_light
    assert scene.lights[1] == Sky(40.0, 10.0).sun()
    assert scene.camera.exposure_stops is None
    chosen = with_sky(Scene(camera=Camera(exposure_stops=-9.0)), Sky())
    assert chosen.camera.exposure_stops == -9.0


def test_the_sky_follows_a_sun_that_a_hand_has_turned():
    scene = with_sky(Scene(), Sky(40.0, 10.0, turbidity=4.0))
    assert followed(scene) is scene
    towards = Sky(20.0, 200.0).towards_sun
    light = replace(scene.lights[-1], direction=tuple(-towards))
    turned = followed(replace(scene, lights=(light,)))
    sky = turned.environment.sky
    assert (sky.elevation_deg, sky.azimuth_deg) == pytest.approx((20.0, 200.0))
    assert sky.turbidity == 4.0
    assert turned.lights == (sky.sun(),)
    # Below the horizon it is dusk, and no further down than the model goes.
    down = followed(replace(scene, lights=(replace(light, direction=(0.0, 1.0, 0.0)),)))
    assert down.environment.sky.elevation_deg == -18.0
    assert down.lights[0].irradiance == (0.0, 0.0, 0.0)


def test_the_disk_is_seen_and_the_horizon_is_sharp(gpu):
    """A camera towards a low sun, nothing else: the disk's size, and two rows for the horizon."""
    sky = Sky(elevation_deg=2.0, azimuth_deg=0.0)
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y_deg=8.0)
    images = {
        is_seen: render(
            replace(with_sky(Scene(), replace(sky, disk=is_seen)), camera=camera),
            technique="direct",
            size=(160, 160),
            samples=1,
        ).radiance
        for is_seen in (True, False)
    }
    disk = images[True].sum(axis=2) - images[False].sum(axis=2) > 100.0
    # pi (.2665 / 8 * 160)^2 pixels in the middle column, 2 of 8 degrees above the middle.
    assert disk.sum() == pytest.approx(np.pi * (0.2665 / 8.0 * 160.0) ** 2, rel=0.05)
    rows, columns = np.nonzero(disk)
    assert rows.mean() == pytest.approx(79.5 - 40.0, abs=0.6)
    assert columns.mean() == pytest.approx(79.5, abs=0.6)
    column = images[False][:, 10].sum(axis=1)
    steps = np.abs(np.diff(column))
    assert steps.argmax() == 79
    assert steps[79] > 10.0 * np.delete(steps, 79).max()


def test_a_map_with_a_horizon_for_who_blends_everywhere():
    rows = np.repeat(np.array([4.0, 2.0, 1.0, 0.5], np.float32)[:, None, None], 8, axis=1)
    sky = Environment(map=np.repeat(rows, 3, axis=2), horizon=True)
    fine = sky.rows_apart(4)[:, 0, 0]
    assert len(fine) == 16
    assert fine[7] == 2.0
    assert fine[8] == 1.0
    assert fine[0] == 4.0
    assert np.all(np.diff(fine) <= 0.0)
    assert Environment(map=sky.map).rows_apart(4).shape == (4, 8, 3)


def test_a_sun_that_is_no_text_is_refused_in_words():
    with pytest.raises(SceneError, match="says no sun"):
        load("builtin:cornell", sun=(25.0, 140.0))  # type: ignore[arg-type]
