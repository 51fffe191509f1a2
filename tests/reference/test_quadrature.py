"""The analytic answers against brute force and SciPy: each by a way of its own."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate

from airlight.reference import quadrature as q

CUBE = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


def irradiance_by_sampling(point, normal, corners, count=400):
    """The same integral over the rectangle's area, midpoint rule."""
    a, b, _, d = (np.array(c, float) for c in corners)
    s = (np.arange(count) + 0.5) / count
    u, v = (m[..., None] for m in np.meshgrid(s, s))
    at = a + u * (b - a) + v * (d - a) - point
    area_normal = np.cross(b - a, d - a)
    r2 = np.sum(at * at, axis=-1)
    receive = np.maximum(at @ np.array(normal), 0.0)
    send = np.maximum(-(at @ area_normal), 0.0)
    return float(np.sum(receive * send / r2**2) / count**2)


RECTANGLES = {
    "wall": [(0, 0, 0), (2, 0, 0), (2, 1.5, 0), (0, 1.5, 0)],
    "ceiling": [(-1, 2, -1), (2, 2, -1), (2, 2, 1), (-1, 2, 1)],
    "dips below the floor": [(0, -1, 0), (2, -1, 0), (2, 1.5, 0), (0, 1.5, 0)],
    "tilted": [(0, -0.5, -0.3), (2, -0.5, -0.3), (2, 1.5, 0.4), (0, 1.5, 0.4)],
}


@pytest.mark.parametrize("name", RECTANGLES)
def test_a_floor_gets_from_a_rectangle_what_sampling_its_area_says(name):
    corners = RECTANGLES[name]
    points = np.array([[0.3, 0, 0.7], [1.0, 0, 2.5], [-1.2, 0, 0.9]])
    up = np.tile([0.0, 1.0, 0.0], (3, 1))
    got = q.polygon_irradiance(points, up, corners)
    want = [irradiance_by_sampling(p, (0, 1, 0), corners) for p in points]
    np.testing.assert_allclose(got, want, rtol=2e-3, atol=1e-6)


def test_a_vast_ceiling_is_a_sky_and_its_back_is_dark():
    size = 1e6
    ceiling = [(-size, 1, -size), (size, 1, -size), (size, 1, size), (-size, 1, size)]
    assert q.polygon_irradiance([0, 0, 0], [0, 1, 0], ceiling, 2.0) == pytest.approx(2 * math.pi)
    assert q.polygon_irradiance([0, 0, 0], [0, 1, 0], ceiling[::-1], 2.0) == 0.0


def test_floor_and_wall_at_right_angles_have_the_textbook_form_factor():
    """Two unit squares sharing an edge: F = 0.20004 (Hottel; Howell, configuration C-14)."""
    x, w = q.panels(24, 8)
    gx, gz = np.meshgrid(x, x)
    points = np.stack([gx, 0 * gx, gz], axis=-1)
    up = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    wall = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    mean = np.einsum("ij,i,j", q.polygon_irradiance(points, up, wall), w, w) / math.pi
    assert mean == pytest.approx(0.200044, abs=2e-5)


@pytest.mark.parametrize("g", [-0.9, 0.0, 0.5, 0.95])
def test_the_phase_function_integrates_to_one_and_its_mean_cosine_is_g(g):
    x, w = q.panels(64)
    theta = math.pi * x  # the lobe is narrow in the cosine, not in the angle
    mu, w = np.cos(theta), w * 0.5 * math.pi * np.sin(theta)
    p = q.henyey_greenstein(mu, g) * 4 * math.pi
    assert np.sum(p * w) == pytest.approx(1.0, abs=1e-9)
    assert np.sum(p * mu * w) == pytest.approx(g, abs=1e-9)


def test_paths_through_a_box_and_a_sphere():
    entry, leave = q.box_path([[-1, 0.5, 0.5], [0.5, 0.5, 0.5], [-1, 2, 0.5]], [1.0, 0, 0], CUBE)
    np.testing.assert_allclose(entry, [1, 0, 0])
    np.testing.assert_allclose(leave, [2, 0.5, 0])
    diagonal = np.full(3, 1 / math.sqrt(3))
    assert np.diff(q.box_path(-diagonal, diagonal, CUBE))[0] == pytest.approx(math.sqrt(3))
    entry, leave = q.sphere_path([[0, 0, -3], [0, 0, 0], [0, 3, 0]], [0, 0, 1.0], [0, 0, 0], 2.0)
    np.testing.assert_allclose(entry, [1, 0, 0])
    np.testing.assert_allclose(leave, [5, 2, 0])


def test_a_furnace_is_even():
    assert q.white_furnace(2.0) == pytest.approx((8 * math.pi, 2 * math.pi))


@pytest.mark.parametrize("axis", [None, (0.6, -0.8, 0.0)])
def test_a_point_light_scattered_once_equals_adaptive_quadrature(axis):
    light, eye, ray = np.array([0.5, 1.0, -2.0]), np.array([0.0, 0.2, 0.0]), np.array([0, 0, -1.0])
    sigma_t, albedo, g, length = 0.6, 0.8, 0.4, 5.0

    def integrand(t):
        at = eye + t * ray
        r = np.linalg.norm(at - light)
        away = (at - light) / r
        value = math.exp(-sigma_t * (t + r)) / r**2 * float(q.henyey_greenstein(-away @ ray, g))
        return value * (1.0 if axis is None else float(q.spot_falloff(away @ axis, 20.0, 60.0)))

    want = 3.0 * sigma_t * albedo * integrate.quad(integrand, 0, length, limit=400)[0]
    got = q.point_single_scatter(
        eye, ray, length, tuple(light), 3.0, sigma_t, albedo, g, axis=axis, cone_deg=(20.0, 60.0)
    )
    assert got == pytest.approx(want, rel=1e-6)


def test_parallel_light_scattered_once_equals_adaptive_quadrature():
    travel = np.array([0.48, -0.8, 0.36])
    eye, ray = np.array([0.3, 0.35, 3.0]), np.array([0.0, 0.1, -1.0]) / math.sqrt(1.01)
    entry, leave = (float(t) for t in q.box_path(eye, ray, CUBE))

    def integrand(t):
        lit = float(q.box_path(eye + t * ray, -travel, CUBE)[1])
        return math.exp(-2.0 * (lit + t - entry))

    phase = float(q.henyey_greenstein(-ray @ travel, 0.3))
    want = 2.0 * 0.5 * 4.0 * phase * integrate.quad(integrand, entry, leave, limit=400)[0]
    got = q.directional_single_scatter(eye, ray, tuple(travel), 4.0, 2.0, 0.5, 0.3, CUBE)
    assert got == pytest.approx(want, rel=1e-5)


def test_the_box_seen_from_afar_is_the_sum_of_its_rays():
    """Radiance over the projected front equals the volume integral, seen straight on."""
    travel, view = (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)
    x, w = q.panels(8)
    gx, gy = np.meshgrid(x, x)
    eyes = np.stack([gx, gy, 0 * gx + 2.0], axis=-1)
    rays = np.broadcast_to([0.0, 0.0, -1.0], eyes.shape)
    radiance = q.directional_single_scatter(eyes, rays, travel, 1.0, 1.5, 0.7, 0.6, CUBE, count=8)
    got = q.box_single_scatter_intensity(travel, view, 1.0, 1.5, 0.7, 0.6, CUBE)
    assert got == pytest.approx(float(np.einsum("ij,i,j", radiance, w, w)), rel=1e-6)
