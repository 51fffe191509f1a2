"""Attenuation and its means against quadrature; ray intervals against points on the ray."""

import numpy as np
import pytest
from scipy.integrate import quad

from airlight.maths import medium


def test_transmittance_multiplies_along_a_path() -> None:
    sigma = np.array([0.1, 1.0, 5.0])
    ab = medium.transmittance(sigma, 0.7) * medium.transmittance(sigma, 1.6)
    np.testing.assert_allclose(ab, medium.transmittance(sigma, 2.3))


@pytest.mark.parametrize("x", [0.0, 1e-12, 1e-4, 0.0199, 0.0201, 0.399, 0.401, 1.0, 30.0, 1000.0])
def test_means_against_quadrature(x: float) -> None:
    points = [min(1.0, k / x) for k in (1.0, 10.0)] if x > 1.0 else None
    mean, _ = quad(lambda t: np.exp(-x * t), 0.0, 1.0, points=points, limit=200, epsabs=0.0)
    first, _ = quad(lambda t: t * np.exp(-x * t), 0.0, 1.0, points=points, limit=200, epsabs=0.0)
    assert float(medium.mean_transmittance(x)) == pytest.approx(mean, rel=1e-9)
    assert float(medium.mean_absorption_depth(x)) == pytest.approx(first / mean, rel=1e-9)


def test_a_ball_that_glows_is_seen_from_afar() -> None:
    """Its middle alone would show exp(-x) of its light."""
    for x in (0.1, 1.0, 2.0):
        radius = x * np.sqrt(5.0 / 3.0)
        for beyond in (0.0, 3.0):
            # Slices of the ball, each through what lies before it.
            mean, _ = quad(lambda z, r=radius: (r * r - z * z) * np.exp(z - r), -radius, radius)
            mean *= np.exp(-beyond) / (4.0 / 3.0 * radius**3)
            depth = radius + beyond
            assert medium.transmittance_from_within(depth, x) == pytest.approx(mean, rel=0.02)
    # Where no medium is left on the path nothing is lost, whatever lies on other sides.
    np.testing.assert_allclose(medium.transmittance_from_within([0.0, 1e-9], 3.0), 1.0)


def test_means_are_finite_for_any_depth() -> None:
    x = np.concatenate([[0.0], np.geomspace(1e-300, 1e300, 601)])
    for f in (medium.mean_transmittance, medium.mean_absorption_depth):
        assert np.isfinite(f(x)).all()
        assert (np.diff(f(x)) <= 1e-12).all()


def rays(count: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(8)
    d = rng.normal(size=(count, 3))
    d[: count // 4, 0] = 0.0  # along a slab
    return rng.normal(size=(count, 3)) * 1.5, d / np.linalg.norm(d, axis=1, keepdims=True)


def assert_interval(t0: np.ndarray, t1: np.ndarray, o: np.ndarray, d: np.ndarray, inside) -> None:  # type: ignore[no-untyped-def]
    """Points of each ray are inside exactly where the interval says."""
    assert (t0 < t1).sum() > 100
    assert (t0 > t1).sum() > 100
    for t in np.linspace(-6.0, 6.0, 61):
        near_end = np.minimum(np.abs(t - t0), np.abs(t - t1)) < 1e-6
        said = (t0 < t) & (t < t1)
        assert (said == inside(o + t * d))[~near_end].all()


def test_ray_box() -> None:
    o, d = rays()
    low, high = np.array([-1.0, -0.5, 0.2]), np.array([0.4, 1.0, 1.3])
    t0, t1 = medium.ray_box_interval(o, d, low, high)
    assert_interval(t0, t1, o, d, lambda p: ((p > low) & (p < high)).all(axis=1))


def test_ray_box_with_an_origin_on_a_face() -> None:
    t0, t1 = medium.ray_box_interval([0.0, 0.5, 0.5], [0.0, 0.0, 1.0], [0, 0, 0], [1, 1, 1])
    assert (t0, t1) == (-0.5, 0.5)


def test_ray_sphere() -> None:
    o, d = rays()
    c = np.array([0.3, -0.2, 0.5])
    t0, t1 = medium.ray_sphere_interval(o, d, c, 0.9)
    assert_interval(t0, t1, o, d, lambda p: np.linalg.norm(p - c, axis=1) < 0.9)


def test_far_sphere_keeps_its_digits() -> None:
    t0, t1 = medium.ray_sphere_interval([0.0, 0.0, -1e8], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0], 1.0)
    np.testing.assert_allclose([t0, t1], [1e8 - 1.0, 1e8 + 1.0], rtol=1e-15)


@pytest.mark.parametrize("half_deg", [3.0, 30.0, 80.0])
def test_ray_cone(half_deg: float) -> None:
    o, d = rays(20_000)
    apex, axis = np.array([0.2, 0.1, -0.4]), np.array([0.6, 0.0, 0.8])
    cosine = np.cos(np.deg2rad(half_deg))

    def inside(p: np.ndarray) -> np.ndarray:
        v = p - apex
        return np.asarray(v @ axis > cosine * np.linalg.norm(v, axis=1))

    t0, t1 = medium.ray_cone_interval(o, d, apex, axis, cosine)
    assert_interval(t0, t1, o, d, inside)


def test_ray_light_geometry() -> None:
    h, t_eye = medium.ray_light_geometry([1.0, 2.0, 3.0], [0.0, 0.0, -1.0], [1.0, 5.0, -1.0])
    assert (float(h), float(t_eye)) == (3.0, -4.0)
