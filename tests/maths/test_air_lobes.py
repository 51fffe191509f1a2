"""Light in the air as lobes: limits, moments, and the shader's twins."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths import air_lobes
from airlight.maths.colour import luminance
from airlight.maths.phase import ISOTROPIC, scattering_phase

Evaluate = Callable[..., np.ndarray]
COUNT = 2000
RNG = np.random.default_rng(17)


def _unit(count):
    d = RNG.normal(size=(count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def _single(x):
    return np.asarray(x, np.float32).astype(np.float64)


def test_a_beam_is_scattered_by_the_phase_function_and_light_from_all_sides_evenly():
    mean, way, travel, g = np.array([1.0, 2.0, 0.5]), _unit(5), _unit(5), np.array([0.8, 0.3, -0.4])
    beam = air_lobes.scattered_lobe(np.tile(mean, (5, 1)), luminance(mean) * way, travel, g)
    cosine = (way * travel).sum(axis=1)[:, None]
    expected = mean * scattering_phase(cosine, g) / ISOTROPIC
    np.testing.assert_allclose(beam, expected, rtol=1e-9)
    assert (beam > 0.0).all()
    # Without a way of its own every direction has its mean.
    even = air_lobes.scattered_lobe(np.tile(mean, (5, 1)), np.zeros((5, 3)), travel, g)
    np.testing.assert_allclose(even, np.tile(mean, (5, 1)))


@pytest.mark.parametrize("g", [0.7, -0.5])
def test_scattering_keeps_the_mean_and_g_of_the_direction(g):
    """Over all directions, by quadrature: what two bands of harmonics would have, too."""
    z, weight = np.polynomial.legendre.leggauss(64)
    travel = np.stack([np.sqrt(1.0 - z**2), 0.0 * z, z], axis=-1)
    along = np.tile([0.0, 0.0, 0.6], (64, 1))
    found = air_lobes.scattered_lobe(np.ones((64, 3)), along, travel, (g,) * 3)[:, 0]
    assert 0.5 * (weight * found).sum() == pytest.approx(1.0, rel=1e-6)
    assert 0.5 * (weight * z * found).sum() == pytest.approx(0.6 * g, rel=1e-6)


def test_shaders_have_the_same_lobes(wgsl: Evaluate) -> None:
    mean, along = _single(RNG.random((COUNT, 3))), _single(RNG.uniform(-1.0, 1.0, (COUNT, 3)))
    one, other = _single(_unit(COUNT)), _single(_unit(COUNT))
    g = _single(RNG.uniform(-0.8, 0.8, (COUNT, 3)))
    # A lobe as sharp as .8 magnifies rounding of its cosine by up to 60.
    found = wgsl("air_lobes", "scattered_lobe", mean, along, one, g, returns="vec3f")
    truth = air_lobes.scattered_lobe(mean, along, one, g)
    np.testing.assert_allclose(found, truth, rtol=3e-4, atol=1e-6)
    flow = np.concatenate([along, _single(luminance(mean))[:, None]], axis=1)
    found = wgsl("air_lobes", "turned_lobe", flow, one, other, g, returns="vec3f")
    truth = air_lobes.turned_lobe(flow, one, other, g)
    np.testing.assert_allclose(found, truth, rtol=3e-4)
    ratio = [air_lobes.scattered_lobe(mean, along, way, g) for way in (one, other)]
    np.testing.assert_allclose(truth, ratio[0] / ratio[1], rtol=1e-5)
