"""Single scattering along a ray against adaptive quadrature."""

import numpy as np
import pytest
from scipy.integrate import quad

from airlight.maths import airlight
from airlight.maths.phase import henyey_greenstein


def point_by_quadrature(h: float, t0: float, t1: float, sigma: float, g: float) -> float:
    def f(t: float) -> float:
        r = np.hypot(h, t)
        return float(henyey_greenstein(-t / r, g)) * np.exp(-sigma * (t - t0 + r)) / (r * r)

    inner = [p for p in (-h, 0.0, h) if t0 < p < t1]
    return quad(f, t0, t1, points=inner or None, limit=500)[0]


CASES = [
    (h, t0, t1, sigma)
    for h in (0.05, 1.0, 4.0)
    for t0, t1 in ((-6.0, 6.0), (-3.0, -1.0), (0.5, 9.0))
    for sigma in (0.0, 0.1, 1.0)
]


def relative_error(nodes: int, g: float) -> float:
    errors = []
    for h, t0, t1, sigma in CASES:
        truth = point_by_quadrature(h, t0, t1, sigma, g)
        value = float(airlight.point_airlight(h, t0, t1, t0, sigma, g, nodes))
        errors.append(abs(value / truth - 1.0))
    return max(errors)


def test_point_light_by_nodes() -> None:
    # measured 1.7e-3, 2.0e-4, 1e-6 (the notes, on cases of their own: 3.2e-3, 8e-4)
    assert relative_error(8, 0.0) < 1.8e-3
    assert relative_error(16, 0.0) < 2.1e-4
    assert relative_error(32, 0.0) < 2e-6


def test_point_light_with_a_phase_function() -> None:
    assert relative_error(8, 0.5) < 4e-4
    assert relative_error(8, 0.8) < 7e-3
    assert relative_error(16, 0.8) < 4e-5


def test_point_light_in_clear_air_is_the_angle_over_the_distance() -> None:
    value = airlight.point_airlight(2.0, -2.0, 2.0 * np.sqrt(3.0), 0.0, 0.0)
    assert float(value) == pytest.approx((np.pi / 4 + np.pi / 3) / 2.0 / (4 * np.pi), rel=1e-12)


def test_point_light_per_channel_and_pixel() -> None:
    h = np.array([[1.0], [2.0], [3.0]])
    sigma = np.array([0.1, 0.5, 1.0])
    value = airlight.point_airlight(h, -1.0, 4.0, -1.0, sigma, [0.0, 0.2, 0.4])
    assert value.shape == (3, 3)
    single = airlight.point_airlight(2.0, -1.0, 4.0, -1.0, 0.5, 0.2)
    assert value[1, 1] == pytest.approx(float(single), rel=1e-12)


def test_a_ray_through_the_light_stays_finite() -> None:
    assert np.isfinite(airlight.point_airlight(0.0, -5.0, 5.0, -5.0, 0.2))
    assert float(airlight.point_airlight(1.0, 2.0, 2.0, 0.0, 0.2)) == 0.0
    assert float(airlight.point_airlight(1.0, 3.0, 2.0, 0.0, 0.2)) == 0.0


def test_ray_light_geometry() -> None:
    h, t_eye = airlight.ray_light_geometry([1.0, 2.0, 3.0], [0.0, 0.0, -1.0], [1.0, 5.0, -1.0])
    assert (float(h), float(t_eye)) == (3.0, -4.0)


def test_spot_against_quadrature() -> None:
    h, t0, t1, sigma, off, along = 1.5, -2.0, 3.0, 0.3, 0.8, 0.6
    inner, outer = 0.95, 0.7

    def f(t: float) -> float:
        r = np.hypot(h, t)
        fall = float(airlight.spot_falloff((off * h + along * t) / r, inner, outer))
        return fall * np.exp(-sigma * (t - t0 + r)) / (4 * np.pi * r * r)

    truth = quad(f, t0, t1, limit=500)[0]
    args = (h, t0, t1, t0, sigma, off, along, inner, outer)
    assert float(airlight.spot_airlight(*args, nodes=64)) == pytest.approx(truth, rel=1e-4)
    assert float(airlight.spot_airlight(*args)) == pytest.approx(truth, rel=0.1)


def test_spot_falloff_ends() -> None:
    np.testing.assert_allclose(
        airlight.spot_falloff([0.5, 0.7, 0.8, 0.9, 1.0], 0.9, 0.7), [0, 0, 0.5, 1, 1], atol=1e-12
    )


@pytest.mark.parametrize("slope", [-1.0, -0.5, 0.0, 0.9])
@pytest.mark.parametrize("sigma", [0.0, 1e-5, 0.3, 4.0])
def test_directional_against_quadrature(slope: float, sigma: float) -> None:
    length, s0, mu, g = 5.0, 4.6, 0.3, 0.6
    truth = quad(
        lambda t: float(henyey_greenstein(mu, g)) * np.exp(-sigma * (t + s0 + slope * t)), 0, length
    )[0]
    value = airlight.directional_airlight(length, s0, slope, sigma, mu, g)
    assert float(value) == pytest.approx(truth, rel=1e-9)
