"""The default sun and sky."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.io.daylight import clear_sky, sun_and_sky, sun_for
from airlight.scene.io.defaults import with_default_camera
from airlight.scene.io.obj import load_obj
from airlight.scene.io.probe import Probe

UP = np.array([0.0, 1.0, 0.0])


def row_solid_angles(height: int) -> np.ndarray:
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    return (edges[:-1] - edges[1:]) * np.pi / height


def test_the_sky_gives_open_ground_a_quarter_of_its_light():
    sky = clear_sky(np.array([0.6, 0.8, 0.0]))
    assert sky.shape == (256, 512, 3)
    assert sky.dtype == np.float32
    v = (np.arange(256) + 0.5) / 256
    weight = row_solid_angles(256) * np.maximum(np.cos(np.pi * v), 0)
    irradiance = (sky * weight[:, None, None]).sum(axis=(0, 1))
    assert 5 < irradiance.mean() < 11


def test_colours_of_the_sky():
    sky = clear_sky(np.array([0.0, 0.8, 0.6]))
    zenith, horizon, ground = sky[0, 0], sky[112].mean(axis=0), sky[160].mean(axis=0)
    assert zenith[2] > 2 * zenith[0]
    assert horizon.sum() > zenith.sum()
    assert ground.sum() < 0.25 * horizon.sum()
    above = sky[:128].reshape(-1, 3)
    assert above.min() > 0.8
    assert above.max() < 5


def test_the_glow_is_where_the_sun_is():
    """The map's orientation is Environment's: u = atan2(x, -z) / 2 pi."""
    for towards in ([0.8, 0.6, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.6, 0.8], [0.0, 0.6, -0.8]):
        sky = clear_sky(np.array(towards))
        red = sky[:112, :, 0]
        column = int(np.argmax((red - red.min(axis=1, keepdims=True)).sum(axis=0)))
        u = np.arctan2(towards[0], -towards[2]) / (2 * np.pi) % 1
        assert abs((column + 0.5) / 512 - u + 0.5) % 1 == pytest.approx(0.5, abs=0.02)


def test_sun_and_sky_belong_together():
    sun, sky = sun_and_sky(np.array([0.6, 0.8, 0.0]))
    assert sun.direction == pytest.approx((-0.6, -0.8, 0))
    assert sun.irradiance == (30, 27, 22)
    assert sky.map is not None


def test_the_sun_enters_the_living_room_through_its_windows(shared_data):
    scene = with_default_camera(load_obj(shared_data / "living_room" / "living_room.obj"))
    towards_sun, lit_share = sun_for(Probe.of(scene), scene.camera)
    assert lit_share > 0.02
    # The windows are at the far end, towards -Z.
    assert towards_sun[2] < -0.5
    elevation_deg = np.degrees(np.arcsin(towards_sun[1]))
    assert 24 < elevation_deg < 61
