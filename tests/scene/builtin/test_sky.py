"""The clear sky: blue overhead, bright around the sun, but no sun disk in it."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene.builtin.sky import clear_sky


def test_zenith_glow_and_ground() -> None:
    sky = clear_sky((0.26, -0.88, 0.36)).map
    assert sky is not None and sky.shape == (64, 128, 3)
    zenith = sky[0].mean(axis=0)
    assert 1.0 < zenith.mean() < 3.0 and zenith[2] > 1.4 * zenith[0]
    upper = sky[:31].mean(axis=2)
    assert upper.max() < 8.0 * zenith.mean()
    ground = sky[40:]
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
