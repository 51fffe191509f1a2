"""Closed forms of lights with extent against quadrature and known view factors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths import area_light
from airlight.maths.cosines_fit import ggx_lobe
from airlight.maths.sampling import orthonormal_frame

Evaluate = Callable[..., np.ndarray]
RNG = np.random.default_rng(5)


def points_on(corners: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
    """Middles of side x side parts of a parallelogram, and their solid angles from the origin."""
    at = (np.arange(side) + 0.5) / side
    u, v = (x.ravel()[:, None] for x in np.meshgrid(at, at))
    along, up = corners[1] - corners[0], corners[3] - corners[0]
    points = corners[0] + u * along + v * up
    normal = np.cross(along, up) / side**2
    distance = np.linalg.norm(points, axis=1)
    return points / distance[:, None], np.abs(points @ normal) / distance**3


@pytest.mark.parametrize("seed", range(6))
def test_polygons_also_where_the_horizon_cuts_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first, along, up = rng.normal(size=3, loc=(0, 0, 0.7)), rng.normal(size=3), rng.normal(size=3)
    corners = np.array([first, first + along, first + along + up, first + up])
    towards, angles = points_on(corners, 700)
    expected = float((np.maximum(towards[:, 2], 0.0) * angles).sum())
    # The middles of 700 x 700 parts: an edge of the horizon is off by half of one.
    assert area_light.polygon_irradiance(corners) == pytest.approx(expected, rel=3e-3)
    assert area_light.polygon_irradiance(corners[::-1]) == pytest.approx(expected, rel=3e-3)


def test_a_rectangle_over_a_floor() -> None:
    # Howell's view factor from a point to a parallel rectangle with a corner above it.
    a, b, height = 1.3, 0.7, 0.9
    x, y = a / height, b / height
    factor = (
        x / np.hypot(1, x) * np.arctan(y / np.hypot(1, x))
        + y / np.hypot(1, y) * np.arctan(x / np.hypot(1, y))
    ) / (2.0 * np.pi)
    corners = np.array([(0, 0, height), (a, 0, height), (a, b, height), (0, b, height)])
    assert area_light.polygon_irradiance(corners) == pytest.approx(np.pi * factor, rel=1e-12)


@pytest.mark.parametrize("centre", [(0, 0, 2), (1, 0, 0.3), (1, 0.4, -0.2), (0.3, 0.5, 0.1)])
def test_spheres_and_the_disks_that_fill_their_cones(centre: tuple[float, ...]) -> None:
    middle, radius = np.array(centre, float), 0.55
    expected = area_light.sphere_irradiance(middle, radius)
    normal, wide = area_light.sphere_disk(middle, radius)
    rim = area_light.rim(middle, normal, wide)
    # Twelve corners of the same area: measured 1.5e-4 at most, 3e-4 where the horizon cuts.
    assert area_light.polygon_irradiance(rim) == pytest.approx(expected, rel=6e-4)


def test_a_disk_overhead() -> None:
    for radius in (0.1, 1.0, 4.0):
        rim = area_light.rim(np.array((0, 0, 1.0)), np.array((0, 0, -1.0)), radius)
        expected = np.pi * radius**2 / (1.0 + radius**2)
        assert area_light.polygon_irradiance(rim) == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("alpha", [0.04, 0.25, 0.6])
def test_the_specular_lobe_over_a_panel(alpha: float) -> None:
    for cosine in (0.95, 0.7):
        view = np.array((np.sqrt(1.0 - cosine**2), 0.0, cosine))
        mirrored = 1.5 * view * (-1, -1, 1)
        side, up = orthonormal_frame(mirrored / 1.5)
        corners = mirrored + 0.6 * np.array([-side - up, side - up, side + up, up - side])
        towards, angles = points_on(corners, 300)
        value, _, _ = ggx_lobe(view, towards, alpha)
        expected = float((value * angles).sum())
        share = area_light.specular_share(corners, view, alpha)
        _, albedos = area_light.specular_cosine(cosine, alpha)
        # What one cosine can do of GGX's lobe (Heitz2016, figure 7): measured 3 % here at most.
        assert share * albedos.sum() == pytest.approx(expected, rel=0.05)


def test_all_around_the_lobe_is_whole() -> None:
    corners = np.array([(-1, -1, 1e-4), (1, -1, 1e-4), (1, 1, 1e-4), (-1, 1, 1e-4)])
    share = area_light.specular_share(corners, np.array((0.0, 0.0, 1.0)), 0.5)
    assert share == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("seed", range(6))
def test_lines_also_where_the_horizon_cuts_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, normal = rng.normal(size=(3, 3), loc=(0, 0, 0.4))
    normal /= np.linalg.norm(normal)
    at = (np.arange(20000)[:, None] + 0.5) / 20000
    points, length = a + at * (b - a), float(np.linalg.norm(b - a))
    distance = np.linalg.norm(points, axis=1)
    even = np.maximum(points @ normal, 0.0) / distance**3
    sine = np.linalg.norm(np.cross(points, (b - a) / length), axis=1) / distance
    found = area_light.segment_irradiance(a, b, normal, 1e-6)
    expected = (length * (sine * even).mean(), length * even.mean())
    # Middles of 20,000 parts: an edge of the horizon is off by half of one.
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-6)


def test_a_thin_cylinder_is_the_panel_that_faces_the_receiver() -> None:
    a, b, radius = np.array((-0.4, 0.3, 0.9)), np.array((0.8, 0.3, 0.7)), 0.004
    normal = np.array((0.0, 0.0, 1.0))
    side = radius * np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    panel = np.array([a - side, b - side, b + side, a + side])
    cylinder, _ = area_light.segment_irradiance(a, b, normal, radius)
    expected = area_light.polygon_irradiance(panel)
    assert 2.0 * radius * cylinder == pytest.approx(expected, rel=1e-4)


def test_lines_are_no_closer_than_their_width() -> None:
    a, b, normal = np.array((-1.0, 0, 1e-9)), np.array((1.0, 0, 1e-9)), np.array((0.0, 0, 1))
    near = area_light.segment_irradiance(a, b, normal, 0.1)
    far = area_light.segment_irradiance(a + 0.1 * normal, b + 0.1 * normal, normal, 0.1)
    assert near[0] < far[0]
    assert near[1] < far[1]


def test_what_leaves_the_gap_above_a_panel() -> None:
    # Two disks of radius 1: all light leaves where they are far apart, h / R where they are close.
    up = np.array((0.0, 0.0, 1.0))
    assert area_light.leaving_share(np.array((0, 0, 100.0)), up, 1.0, 9e9) == pytest.approx(
        1, abs=1e-3
    )
    assert area_light.leaving_share(np.array((0, 0, 0.01)), up, 1.0, 9e9) == pytest.approx(
        0.01, rel=0.01
    )
    assert area_light.leaving_share(np.array((3, 0, 0.01)), up, 1.0, 9e9) == pytest.approx(
        0.9, rel=0.01
    )
    assert area_light.leaving_share(np.array((0, 0, 0.4)), up, 1.0, 0.2) == 1.0
    assert area_light.leaving_share(np.array((0, 0, 0.01)), up, 0.0, 9e9) == pytest.approx(
        1, abs=1e-6
    )


def test_twins(wgsl: Evaluate) -> None:
    a, b = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in RNG.normal(size=(2, 200, 3)))
    expected = [area_light.edge_integral(*pair) for pair in zip(a, b, strict=True)]
    found = wgsl("area_light", "edge_integral", a, b)
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=2e-4)
    centre, radius = RNG.normal(size=(200, 3)), RNG.uniform(0.05, 0.5, 200)
    centre *= 1.5 * np.maximum(1.0, radius / np.linalg.norm(centre, axis=1))[:, None]
    found = wgsl("area_light", "sphere_irradiance", centre, radius)
    expected = [area_light.sphere_irradiance(*each) for each in zip(centre, radius, strict=True)]
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=5e-4)
    away, body, gap = RNG.normal(size=(200, 3)), RNG.uniform(0, 2, 200), RNG.uniform(0, 2, 200)
    found = wgsl("leaving_share", "leaving_share", away, a, body, gap)
    expected = [area_light.leaving_share(*row) for row in zip(away, a, body, gap, strict=True)]
    np.testing.assert_allclose(found, expected, rtol=2e-4, atol=1e-6)
    ends = RNG.normal(size=(2, 200, 3))
    found = wgsl("area_light", "segment_irradiance", *ends, a, 0.1 * radius, returns="vec2f")
    rows = zip(*ends, a, 0.1 * radius, strict=True)
    expected = [area_light.segment_irradiance(*row) for row in rows]
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=5e-4)
    found = wgsl("area_light", "sphere_disk", centre, radius, returns="vec4f")
    disks = [area_light.sphere_disk(*each) for each in zip(centre, radius, strict=True)]
    expected = np.array([(*normal, wide) for normal, wide in disks])
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-5)
