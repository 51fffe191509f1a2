"""An endless medium below a plane: what is known of half spaces."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import expn

from airlight.maths.half_space import _exponential_integral, plane_light, plane_radiance

ONE = np.array([1.0])


@pytest.mark.parametrize("order", [2, 3])
def test_exponential_integrals(order):
    x = np.concatenate([[0.0], np.geomspace(1e-4, 40.0, 60)])
    np.testing.assert_allclose(_exponential_integral(order, x), expn(order, x), atol=1e-6)


def test_without_absorption_all_light_comes_back():
    """What enters leaves again: net flux of scattered light up is what the beam brings down."""
    for cosine in (1.0, 0.5):
        light = plane_light(1.0, np.array([cosine]), ONE)
        assert -light.flux[0] == pytest.approx(cosine, rel=6e-3)
        deep = light.flux + cosine * np.exp(-light.depth / cosine)
        np.testing.assert_allclose(deep, 0.0, atol=6e-3)


@pytest.mark.parametrize(("albedo", "cosine"), [(0.8, 1.0), (0.8, 0.5), (0.95, 0.3)])
def test_the_reflected_light_is_chandrasekhars(albedo, cosine):
    """Plane albedo of a half space: 1 - H(mu) sqrt(1 - albedo) (Chandrasekhar1950)."""
    light = plane_light(albedo, np.array([cosine]), ONE)
    expected = cosine * (1.0 - _h(albedo, cosine) * np.sqrt(1.0 - albedo))
    assert -light.flux[0] == pytest.approx(expected, rel=5e-3)


def test_light_from_below_brings_nothing_and_beams_add_up():
    a, b = (plane_light(0.9, np.array([c]), ONE).scattered for c in (0.9, 0.4))
    both = plane_light(0.9, np.array([0.9, -0.7, 0.4]), np.array([1.0, 5.0, 1.0]))
    np.testing.assert_allclose(both.scattered, a + b, rtol=1e-12)
    # Nothing is above the top; a sum over layers is off by a unit in the last place for each.
    rounding = len(both.sent) * np.finfo(np.float64).eps * both.down.max()
    assert abs(both.down[0]) <= rounding and (both.down[1:] > 0.0).all()


def _h(albedo: float, cosine: float) -> float:
    """Chandrasekhar's H function for even scattering, by iteration."""
    nodes, weights = np.polynomial.legendre.leggauss(64)
    mu, w = 0.5 * (nodes + 1.0), 0.5 * weights

    def step(h, at):
        share = (w * 0.5 * albedo * mu * h / (at[:, None] + mu)).sum(axis=1)
        return 1.0 / (np.sqrt(1.0 - albedo) + share)

    h = np.ones(64)
    for _ in range(200):
        h = step(h, mu)
    return float(step(h, np.array([cosine]))[0])


def test_radiance_adds_up_to_fluence_and_flux():
    """Over all directions, those along which light changes fast among them."""
    light = plane_light(0.9, np.array([0.6]), ONE)
    s, weight = np.polynomial.legendre.leggauss(64)
    mu, solid = s**3, 2.0 * np.pi * 3.0 * s**2 * weight
    depth = np.array([0.0, 0.05, 0.4, 1.5, 3.0])
    seen = plane_radiance(light, depth, mu)
    assert (seen[0, mu > 0.0] == 0.0).all()
    np.testing.assert_allclose(
        seen @ solid, np.interp(depth, light.depth, light.scattered), rtol=0.02
    )
    # Who looks up sees light that comes down.
    np.testing.assert_allclose(
        seen @ (solid * mu), np.interp(depth, light.depth, light.flux), rtol=0.03, atol=2e-3
    )


def test_deep_down_light_comes_from_all_sides_alike():
    """Where nothing is absorbed, a quarter of its fluence over pi."""
    light = plane_light(1.0, ONE, ONE)
    mu = np.array([-0.9, -0.2, 0.2, 0.9])
    seen = plane_radiance(light, np.array([20.0]), mu)[0]
    even = np.interp(20.0, light.depth, light.scattered) / (4.0 * np.pi)
    np.testing.assert_allclose(seen, even, rtol=0.02)
