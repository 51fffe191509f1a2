"""Glowing polygons in stills, by the part of each pixel that they cover."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import Camera, Geometry, Material, Mesh, Scene
from airlight.scene.shapes import quad

SIZE = (32, 24)
SMALL = {"resolution": 8, "surfels": 100, "lamp_resolution": 32, "area_samples": 1}
CAMERA = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov_y_deg=30.0)
LIGHT = Material(base_color=(0, 0, 0), specular=0.0, emission=(40.0, 20.0, 10.0))
BLACK = Material(base_color=(0, 0, 0), specular=0.0)
PX = 2.0 * 4.0 * np.tan(np.radians(15.0)) / SIZE[1]  # m, of a pixel at the lamp


def light(corners, z=0.0) -> Mesh:
    positions = np.array([(x * PX, y * PX, z) for x, y in corners], np.float32)
    faces = [(0, k, k + 1) for k in range(1, len(corners) - 1)]
    normals = np.tile(np.float32((0, 0, 1)), (len(corners), 1))
    return Mesh(Geometry(positions, np.array(faces, np.uint32), normals), LIGHT)


def parts(image) -> np.ndarray:
    return np.asarray(image.layers["direct"][..., 0] / LIGHT.emission[0], np.float64)


def covered(corners) -> float:
    """The part of the box 0..1, 0..1 that a polygon's corners (n, 2) enclose, as coverage.wgsl.

    The sum over edges of the integral along y of x, both held between 0 and 1.
    """
    total = 0.0
    for a, b in zip(np.roll(corners, 1, axis=0), corners, strict=True):
        low, high = np.clip((a[1], b[1]), 0.0, 1.0)
        if low == high:
            continue
        x = a[0] + (np.array((low, high)) - a[1]) * (b[0] - a[0]) / (b[1] - a[1])
        # Left of the box x counts as 0, right of it as 1: its integral is quadratic, then linear.
        within = np.clip(x, 0.0, 1.0)
        integral = 0.5 * within**2 + np.maximum(x - 1.0, 0.0)
        wide = x[1] - x[0]
        mean = within.mean() if abs(wide) < 1e-3 else (integral[1] - integral[0]) / wide
        total += float((high - low) * mean)
    return abs(total)


def exact(corners) -> np.ndarray:
    pixels = np.array(corners) * (1, -1) + (SIZE[0] / 2, SIZE[1] / 2)
    return np.array([[covered(pixels - (x, y)) for x in range(SIZE[0])] for y in range(SIZE[1])])


SLANTED = [(-5.3, -2.1), (4.2, -3.4), (5.7, 2.2), (-1.1, 4.6)]
SMALLER = [(0.2, 0.3), (0.6, 0.2), (0.7, 0.45)]


@pytest.mark.parametrize("corners", [SLANTED, SMALLER], ids=["slanted", "smaller"])
def test_the_sum_over_edges_is_the_area_in_each_box(corners) -> None:
    whole = exact(corners)
    x, y = np.array(corners).T
    area = 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))
    assert whole.sum() == pytest.approx(area, rel=1e-9)
    assert whole.min() >= 0.0
    assert whole.max() <= 1.0 + 1e-12


@pytest.mark.parametrize("corners", [SLANTED, SMALLER], ids=["slanted", "smaller"])
@pytest.mark.parametrize("wall", [False, True])
def test_two_samples_know_a_light_as_many_do(corners, wall) -> None:
    # Also before nothing at all; smaller than a pixel, most samples miss it.
    back = Mesh(
        quad(), BLACK, np.array([[9, 0, 0, 0], [0, 0, -9, 0], [0, 9, 0, -1.0], [0, 0, 0, 1]])
    )
    scene = Scene(meshes=(light(corners), *((back,) if wall else ())), camera=CAMERA)
    image = render(scene, "direct", SIZE, samples=2, settings=SMALL)
    np.testing.assert_allclose(parts(image), exact(corners), atol=2e-3)


def test_what_stands_before_a_light_hides_it() -> None:
    half = Mesh(
        quad(), BLACK, np.array([[2, 0, 0, -1], [0, 0, -2, 0], [0, 2, 0, 1.0], [0, 0, 0, 1]])
    )
    scene = Scene(meshes=(light(SLANTED), half), camera=CAMERA)
    found = parts(render(scene, "direct", SIZE, samples=4, settings=SMALL))
    assert found[:, : SIZE[0] // 2].max() == 0.0
    np.testing.assert_allclose(
        found[:, SIZE[0] // 2 :], exact(SLANTED)[:, SIZE[0] // 2 :], atol=2e-3
    )


def test_lights_that_lie_over_each_other_count_once() -> None:
    square = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)]
    right = [(x + 2.0, y + 1.0) for x, y in square]
    # Two surfaces of one material in one plane; beside each other both are exact.
    scene = Scene(meshes=(light(square), light(right)), camera=CAMERA)
    assert parts(render(scene, "direct", SIZE, samples=8, settings=SMALL)).max() < 1.001
    beside = [(x + 8.5, y) for x, y in square]
    scene = replace(scene, meshes=(light(square), light(beside)))
    found = parts(render(scene, "direct", SIZE, samples=2, settings=SMALL))
    np.testing.assert_allclose(found, exact(square) + exact(beside), atol=2e-3)
