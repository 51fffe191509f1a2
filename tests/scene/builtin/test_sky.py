"""The clear sky: blue overhead, bright around the sun, but no sun disk in it."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import Environment
from airlight.scene.builtin.sky import clear_sky
from airlight.scene.io.daylight import clear_sky as daylight_sky
from airlight.scene.io.daylight import sun_and_sky
from airlight.surface.sky import sky_lights


def test_zenith_glow_and_ground() -> None:
    sky = clear_sky((0.26, -0.88, 0.36)).map
    assert sky is not None and sky.shape == (256, 512, 3)
    zenith = sky[0].mean(axis=0)
    assert 1.0 < zenith.mean() < 3.0 and zenith[2] > 1.4 * zenith[0]
    upper = sky[:128].mean(axis=2)
    assert upper.max() < 8.0 * zenith.mean()
    ground = sky[128:]
    assert np.all(ground == ground[0, 0])


def test_brightest_towards_the_sun_in_mitsubas_orientation() -> None:
    travel = np.array((-0.7, -0.45, 0.3))
    towards = -travel / np.linalg.norm(travel)
    grey = clear_sky(tuple(travel), height_px=128).map.mean(axis=2)
    row, column = np.unravel_index(np.argmax(grey), grey.shape)
    u = np.arctan2(towards[0], -towards[2]) / (2 * np.pi) % 1.0
    v = np.arccos(towards[1]) / np.pi
    assert (row + 0.5) / 128 == pytest.approx(v, abs=0.06)
    assert (column + 0.5) / 256 == pytest.approx(u, abs=0.06)


def test_scale() -> None:
    one, two = (clear_sky((0, -1, 0), scale=s).map for s in (1.0, 2.0))
    assert np.allclose(two, 2.0 * one)


def test_the_horizon_is_sharp_and_no_texel_shows() -> None:
    """Of both skies that are added without a word: a row of sky above one of ground."""
    towards = np.array((0.45, 0.35, -0.82)) / np.linalg.norm((0.45, 0.35, -0.82))
    travel = (float(-towards[0]), float(-towards[1]), float(-towards[2]))
    for environment in (clear_sky(travel), sun_and_sky(towards)[1]):
        assert environment.horizon
        grey = environment.map.mean(axis=2)
        assert grey[127].min() > 3.0 * grey[128].max()
        # Between two rows or columns a line misses the sky by less than a tenth of a code (1 %).
        for values in (grey[:128], grey[32:128].T):
            bend = np.abs(values[2:] + values[:-2] - 2.0 * values[1:-1]) / 8.0
            assert (bend / values[1:-1]).max() < 1e-3


def test_more_rows_leave_the_light_as_it_is() -> None:
    """What a sky gives does not depend on how finely it is seen; measured within .1 %."""
    towards = np.array((0.45, 0.35, -0.82)) / np.linalg.norm((0.45, 0.35, -0.82))
    travel = (float(-towards[0]), float(-towards[1]), float(-towards[2]))
    pairs = (
        (clear_sky(travel), clear_sky(travel, height_px=64)),
        (sun_and_sky(towards)[1], Environment(map=daylight_sky(towards, 64), horizon=True)),
    )
    for fine, coarse in pairs:
        sums = [np.sum([x.irradiance for x in sky_lights(e, 64)], axis=0) for e in (fine, coarse)]
        np.testing.assert_allclose(*sums, rtol=2e-3)
