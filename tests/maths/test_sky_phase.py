"""Skies convolved with phase functions: against direct sums, and what ordinates make of them."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.beam_phase import beam_phase_table
from airlight.maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from airlight.maths.ordinates import partition, uniform_sky
from airlight.maths.phase import henyey_greenstein
from airlight.maths.sky_phase import convolved, sky_gain
from airlight.maths.transforms import F64


def sky(height: int = 48) -> F64:
    towards = latlong_texel_directions(height, 2 * height)
    glow = np.maximum(towards @ np.array([0.48, 0.64, -0.6]), 0.0) ** 40
    return np.asarray(0.3 + 5.0 * glow[..., None] * [1.0, 0.8, 0.5])


def test_it_is_the_integral():
    radiance, g = sky(), (0.0, 0.5, -0.6)
    got = convolved(radiance, g)
    towards = latlong_texel_directions(48, 96)
    power = radiance * latlong_row_solid_angles(48, 96)[:, None, None]
    for row, column in ((3, 5), (20, 60), (47, 0)):
        cosine = towards @ towards[row, column]
        for channel, k in enumerate(g):
            want = (henyey_greenstein(cosine, k) * power[..., channel]).sum()
            assert got[row, column, channel] == pytest.approx(want, rel=2e-3)


@pytest.mark.parametrize("g", [0.9, 0.999, -0.99])
def test_an_uniform_sky_stays_even_and_light_is_kept(g):
    np.testing.assert_allclose(convolved(np.full((200, 400, 3), 2.0), (g,) * 3), 2.0, rtol=1e-9)
    radiance = sky()
    omega = latlong_row_solid_angles(48, 96)[:, None, None]
    got = convolved(radiance, (g,) * 3)
    np.testing.assert_allclose((got * omega).sum(), (radiance * omega).sum(), rtol=0.01)


def test_the_gain_takes_the_spots_off():
    """Of 32 ordinates and g = .95: the sum is 1, where there were spots of tens of percent."""
    g, even = (0.95,) * 3, uniform_sky(32)
    table = beam_phase_table(g, even.mean_cosine)
    gain = sky_gain(convolved(np.ones((48, 96, 3)), g), even, table)
    assert gain.std() > 0.05
    assert gain.mean() == pytest.approx(1.0, abs=0.05)
    low = beam_phase_table((0.3,) * 3, even.mean_cosine)
    exact = convolved(np.ones((48, 96, 3)), (0.3,) * 3)
    np.testing.assert_allclose(sky_gain(exact, even, low), 1, atol=0.01)
    black = sky_gain(np.zeros((8, 16, 3)), partition(np.zeros((8, 16, 3)), 4), table[:4])
    np.testing.assert_array_equal(black, 1.0)
