"""SHDOM against what is known: clear air, a furnace, single scattering, Monte Carlo's cube."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.delta_beam import MediumGrid
from airlight.reference.harmonics import harmonics, quadrature_directions
from airlight.reference.shdom import _Group, environment_series, solve


def box(sigma_t: float, albedo: float = 1.0, g: float = 0.0, shape=(8, 8, 8)) -> MediumGrid:
    one = np.ones(shape)
    extent = np.array(shape[::-1]) / 8.0
    return MediumGrid(extent, one, one, *(np.full(3, v) for v in (sigma_t, albedo, g)))


def test_a_furnace_stays_even():
    outside = environment_series(np.ones((32, 64, 3)), 5)
    for g in (0.0, 0.8):
        done = solve(box(3.0, g=g, shape=(5, 8, 6)), outside, 5, iterations=80, tolerance=1e-4)
        np.testing.assert_allclose(done.fluence, 4.0 * np.pi, rtol=2e-3)
        seen = done.emission(np.array([0.6, 0.0, 0.8]))
        np.testing.assert_allclose(seen, 1.0, rtol=5e-3)


def test_straight_light_falls_off_as_beer_and_lambert_say():
    """Along x, y and z, both ways: exactly; oblique light comes from behind and the sides."""
    air = box(2.0, shape=(6, 10, 8))
    dark, lit = np.zeros((1, 6, 10, 8, 3)), np.ones((1, 3))
    for axis in range(3):
        for sign in (-1.0, 1.0):
            group = _Group(air, sign * np.eye(3)[[axis]], np.array([0]))
            along = np.moveaxis(group.sweep(dark, lit)[0, ..., 0], 2 - axis, 0)[:, 3, 3]
            want = np.exp(-2.0 * (np.arange(len(along)) + 0.5) / 8.0)
            np.testing.assert_allclose(along[:: int(sign)], want)
    oblique = _Group(air, np.array([[0.48, -0.6, 0.64]]), np.array([0]))
    light = oblique.sweep(dark, lit)[0, ..., 0]
    assert light[0, 9, 0] == light.max()
    assert light[5, 0, 7] == light.min()


@pytest.mark.slow
@pytest.mark.needs("numba")
def test_a_cube_scatters_what_monte_carlo_says():
    """Fluence in an isotropic cube under a uniform sky: within 8 %, darker at the walls."""
    from airlight.reference.tracer import BoxMedium, IsotropicEnvironment, trace

    outside = environment_series(np.ones((32, 64, 3)), 5)
    done = solve(box(4.0, 0.8), outside, 5, iterations=60)
    air = BoxMedium(4.0, 0.8, 0.0)
    light = trace(air, IsotropicEnvironment(), cells=(8, 8, 8), photons=60_000)
    want = light.fluence.sum(axis=0)
    got = done.fluence[..., 0]
    assert got.mean() == pytest.approx(want.mean(), rel=0.08)
    assert np.linalg.norm(got - want) < 0.1 * np.linalg.norm(want)


def test_a_sharp_light_rings_unless_it_is_smoothed():
    sky = np.zeros((32, 64, 3))
    sky[8, 20] = 100.0
    directions, _ = quadrature_directions(5)
    rung = harmonics(directions, 5) @ environment_series(sky, 5, prefilter=False)
    smooth = harmonics(directions, 5) @ environment_series(sky, 5)
    assert rung.min() < 3.0 * smooth.min() < 0.0
