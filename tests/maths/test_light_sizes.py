"""Lights with extent as media near them see them: quadrature, and the shaders' own words."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths.light_sizes import (
    ball_reach,
    ball_share,
    rectangle_angle,
    rectangle_direction,
    rectangle_reach,
    sharpness_over,
)
from airlight.maths.phase import henyey_greenstein
from airlight.maths.solid_angle import polygon_solid_angle

Evaluate = Callable[..., np.ndarray]
HALVES = [(1.0, 1.0), (2.0, 0.2)]


def places(half: tuple[float, float], count: int) -> np.ndarray:
    """Points above the rectangle and beside it, none nearer than a tenth of its narrow side."""
    rng = np.random.default_rng(3)
    low, high = (-1.0, -1.0, 0.1), (3.0, 3.0, 3.0)
    return rng.uniform(low, high, (count, 3)) * (*half, min(half))


def parts_seen(at: np.ndarray, half: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Solid angles of 200 x 200 parts of the rectangle, and how far away they are."""
    side = (np.arange(200) + 0.5) / 100.0 - 1.0
    x, y = np.meshgrid(side * half[0], side * half[1])
    away = np.hypot(np.hypot(at[0] - x, at[1] - y), at[2])
    return at[2] / away**3 * 4.0 * half[0] * half[1] / x.size, away


def travels(at: np.ndarray, half: tuple[float, float]) -> np.ndarray:
    """Directions (200, 200, 3) in which light of those parts comes to the point."""
    side = (np.arange(200) + 0.5) / 100.0 - 1.0
    x, y = np.meshgrid(side * half[0], side * half[1])
    path = at - np.stack([x, y, 0.0 * x], axis=-1)
    return path / np.linalg.norm(path, axis=-1, keepdims=True)


@pytest.mark.parametrize("half", HALVES)
def test_a_rectangle_is_as_large_as_any_polygon(half: tuple[float, float]) -> None:
    at = places(half, 60)
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * (*half, 0.0)
    truth = [polygon_solid_angle(corners - p) for p in at]
    np.testing.assert_allclose(rectangle_angle(at, np.array(half)), truth, rtol=1e-9)
    # Right above it is half of all directions; from below it is dark.
    assert rectangle_angle(np.array([0.0, 0.0, 1e-9]), np.array(half)) == pytest.approx(2 * np.pi)
    assert rectangle_angle(np.array([0.0, 0.0, -1.0]), np.array(half)) == 0.0


@pytest.mark.parametrize("half", HALVES)
@pytest.mark.parametrize("depth", [0.3, 1.0])
def test_its_light_is_attenuated_as_that_of_its_parts(
    half: tuple[float, float], depth: float
) -> None:
    """Per half of the long side: the mean of all places, by how much light they get, within 5 %."""
    at, sigma = places(half, 200), depth / max(half)
    angle = rectangle_angle(at, np.array(half))
    found = (angle * np.exp(-sigma * rectangle_reach(at, np.array(half)))).sum()
    seen = [parts_seen(p, half) for p in at]
    truth = sum((part * np.exp(-sigma * away)).sum() for part, away in seen)
    # Measured .996 to 1.03.
    assert found == pytest.approx(truth, rel=0.05)


@pytest.mark.parametrize("g", [0.35, 0.7])
@pytest.mark.parametrize("half", [(1.0, 1.0), (1.25, 1.75)])
def test_its_light_is_scattered_as_that_of_its_parts(half: tuple[float, float], g: float) -> None:
    """Into all directions, and straight on to an eye that looks at a part of the light."""
    rng = np.random.default_rng(4)
    at = places(half, 60)
    angle = rectangle_angle(at, np.array(half))
    mean = rectangle_direction(at, np.array(half), angle)
    found, truth = np.zeros(2), np.zeros(2)
    for k, p in enumerate(at):
        part, directions = parts_seen(p, half)[0], travels(p, half)
        anywhere = rng.normal(size=(20, 3))
        anywhere /= np.linalg.norm(anywhere, axis=1, keepdims=True)
        onwards = directions.reshape(-1, 3)[rng.integers(0, part.size, 20)]
        for j, eyes in enumerate((anywhere, onwards)):
            own = henyey_greenstein(eyes @ mean[k], g * sharpness_over(angle[k]))
            found[j] += angle[k] * own.sum()
            truth[j] += sum((part * henyey_greenstein(directions @ eye, g)).sum() for eye in eyes)
    # Measured .99 to 1.04; of strips ten times as long as wide, seen along them, up to 1.57.
    np.testing.assert_allclose(found / truth, 1.0, atol=0.06)


@pytest.mark.parametrize("half", HALVES)
def test_shaders_say_the_same(wgsl: Evaluate, half: tuple[float, float]) -> None:
    at = np.concatenate(
        [places(half, 500), 40.0 * places(half, 100), places(half, 50) * (1, 1, -1)]
    )
    each = np.tile(half, (len(at), 1))
    angle = rectangle_angle(at, np.array(half))
    # Corners nearly cancel far away; from 20 half diagonals on all is as far away, .05 % off.
    np.testing.assert_allclose(wgsl("light_sizes", "rectangle_angle", at, each), angle, 2e-3, 1e-6)
    mean = rectangle_direction(at, np.array(half), angle)[:550]
    above = wgsl(
        "light_sizes", "rectangle_direction", at[:550], each[:550], angle[:550], returns="vec3f"
    )
    np.testing.assert_allclose(above, mean, atol=1e-5)
    reach = rectangle_reach(at, np.array(half))
    np.testing.assert_allclose(wgsl("light_sizes", "rectangle_reach", at, each), reach, rtol=1e-5)


@pytest.mark.parametrize("depth", [0.3, 1.0, 3.0])
def test_a_ball_is_seen_and_attenuated_as_its_parts_are(depth: float) -> None:
    """Of radius 1: directions within its rim, evenly by their cosine."""
    distance = np.array([1.05, 1.2, 1.5, 2.0, 4.0, 10.0])
    least = np.sqrt(1.0 - 1.0 / distance**2)
    angle = 2.0 * np.pi * (1.0 - least)
    np.testing.assert_allclose(np.pi * ball_share(distance, 1.0), angle, rtol=1e-9)
    share = (np.arange(2000)[:, None] + 0.5) / 2000
    cosine = least + share * (1.0 - least)
    path = distance * cosine - np.sqrt(np.maximum(1.0 - distance**2 * (1.0 - cosine**2), 0.0))
    truth = np.exp(-depth * path).mean(axis=0)
    # Measured .83 to 1.01 through 3 per radius, of which little is left beyond two of them.
    found = np.exp(-depth * ball_reach(distance, 1.0))
    np.testing.assert_allclose(found, truth, rtol=0.06 * max(depth, 1.0), atol=1e-3)


def test_shaders_say_the_same_of_balls(wgsl: Evaluate) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 50)
    found = wgsl("light_sizes", "sharpness_over", angle)
    np.testing.assert_allclose(found, sharpness_over(angle), rtol=1e-6)
    distance = np.geomspace(0.5, 50.0, 200)
    radius = np.full(200, 1.0)
    share = ball_share(distance, 1.0)
    np.testing.assert_allclose(wgsl("light_sizes", "ball_share", distance, radius), share, 1e-3)
    reach = ball_reach(distance, 1.0)
    # The near part of it is a difference.
    np.testing.assert_allclose(
        wgsl("light_sizes", "ball_reach", distance, radius), reach, 1e-3, 1e-5
    )
