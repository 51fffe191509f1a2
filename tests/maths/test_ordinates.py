"""The partition of a map carries its light exactly, spreads evenly, and does not jump."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.colour import luminance
from airlight.maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from airlight.maths.ordinates import (
    importance_sampled,
    joined,
    parallel,
    partition,
    uniform_sky,
)
from airlight.maths.phase import henyey_greenstein
from airlight.maths.transforms import F64


def sky(height: int = 96) -> F64:
    """A gradient with a small sun a thousand times as bright, coloured."""
    towards = latlong_texel_directions(height, 2 * height)
    sun = np.array([0.48, 0.64, -0.6])
    radiance = 0.2 + 0.5 * np.maximum(towards[..., 1:2], 0.0) * np.array([0.5, 0.7, 1.0])
    return np.asarray(radiance + 300.0 * (towards @ sun > 0.998)[..., None] * [1.0, 0.9, 0.7])


@pytest.mark.parametrize("count", [1, 8, 64])
def test_light_and_its_direction_are_kept(count):
    radiance = sky()
    omega = np.repeat(latlong_row_solid_angles(96, 192)[:, None], 192, axis=1)
    towards = latlong_texel_directions(96, 192)
    got = partition(radiance, count)
    want = (radiance * omega[..., None]).sum(axis=(0, 1))
    np.testing.assert_allclose(got.irradiance.sum(axis=0), want, rtol=1e-12)
    assert got.solid_angle.sum() == pytest.approx(4 * np.pi)
    # The first moment of the map's luminance is that of the ordinates.
    moment = (luminance(radiance) * omega)[..., None] * towards
    own = luminance(got.irradiance) * got.mean_cosine
    np.testing.assert_allclose(
        -(own[:, None] * got.direction).sum(axis=0), moment.sum(axis=(0, 1)), rtol=1e-6, atol=1e-6
    )
    np.testing.assert_allclose(np.linalg.norm(got.direction, axis=1), 1.0)


def test_a_sun_gets_an_ordinate_of_its_own():
    got = partition(sky(), 64)
    brightest = int(np.argmax(luminance(got.irradiance)))
    np.testing.assert_allclose(-got.direction[brightest], [0.48, 0.64, -0.6], atol=0.02)
    assert got.mean_cosine[brightest] > 0.998
    assert got.solid_angle[brightest] < got.solid_angle.mean()


def test_an_uniform_sky_is_cut_evenly():
    got = uniform_sky(64)
    np.testing.assert_allclose(got.irradiance.sum(axis=0), 4 * np.pi)
    assert got.solid_angle.max() < 1.4 * got.solid_angle.min()
    assert got.mean_cosine.min() > 0.975
    np.testing.assert_allclose(got.irradiance[:, 0] @ got.direction, 0.0, atol=0.01)


def test_a_drifting_sun_does_not_jump():
    """Turned by a third of a degree a frame, total flux by direction changes smoothly."""
    height = 96
    towards = latlong_texel_directions(height, 2 * height)
    probe = np.array([0.6, 0.3, -0.74])
    seen = []
    for step in range(8):
        angle = np.radians(step / 3.0)
        sun = np.array([np.cos(angle) * 0.8, 0.6, -np.sin(angle) * 0.8])
        blob = np.exp(-(1.0 - towards @ sun) / 2e-3)
        light = partition(0.2 + 30.0 * blob[..., None] * np.ones(3), 32)
        # What a lobe of g = .8 towards the probe would scatter.

        seen.append(
            float(light.irradiance[:, 0] @ henyey_greenstein(-light.direction @ probe, 0.8))
        )
    change = np.abs(np.diff(seen)) / np.mean(seen)
    assert change.max() < 0.03, seen


def test_black_and_tiny_maps():
    black = partition(np.zeros((4, 8, 3)), 5)
    assert np.isfinite(black.direction).all()
    assert black.irradiance.max() == 0.0
    one = partition(np.ones((1, 1, 3)), 3)
    np.testing.assert_allclose(one.irradiance.sum(axis=0), 4 * np.pi)


def test_joined_and_turned():
    sun = parallel((0.0, -1.0, 0.0), (1.0, 2.0, 3.0))
    both = joined([sun, uniform_sky(4)])
    assert both.count == 5
    turned = both.turned(np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]))
    np.testing.assert_allclose(turned.direction[0], [0.0, 0.0, -1.0])
    assert turned.mean_cosine[0] == 1.0


def test_samples_go_where_the_light_is_and_carry_it():
    radiance = sky()
    got = importance_sampled(radiance, 64)
    omega = latlong_row_solid_angles(96, 192)[:, None]
    total = float((luminance(radiance) * omega).sum())
    assert luminance(got.irradiance).sum() == pytest.approx(total)
    np.testing.assert_allclose(luminance(got.irradiance), total / 64)
    to_sun = -got.direction @ np.array([0.48, 0.64, -0.6]) > 0.99
    sun = luminance(radiance) > 10.0
    share = float((luminance(radiance) * omega)[sun].sum()) / total
    assert to_sun.mean() == pytest.approx(share, abs=0.05)
    assert got.mean_cosine[to_sun].min() > got.mean_cosine[~to_sun].max()
    black = importance_sampled(np.zeros((8, 16, 3)), 4)
    assert np.isfinite(black.direction).all()
    assert black.irradiance.max() == 0.0
