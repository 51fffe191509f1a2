"""Thousands of windows and strings of bulbs: their light on a floor, against the sum of all."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.area_light import sphere_irradiance
from airlight.rendering import render
from airlight.scene import Camera, Material, Mesh, Scene
from airlight.scene.mesh import Geometry
from airlight.scene.shapes import quad, sphere

SIZE = (48, 27)
SMALL = {"resolution": 8, "surfels": 100, "lamp_resolution": 128}
MATT = Material(base_color=(0.6, 0.6, 0.6), specular=0.0)
GLOW = Material(base_color=(0, 0, 0), specular=0.0, emission=(9.0, 7.0, 4.0), two_sided=False)


def at(x: float, y: float, z: float, *scale: float) -> np.ndarray:
    placed = np.diag((*scale, 1.0))
    placed[:3, 3] = (x, y, z)
    return placed


def facade() -> tuple[Scene, np.ndarray]:
    """A wall of 100 x 40 m with 50 x 40 windows of 1 x .6 m, some of them dark, over a street."""
    rng = np.random.default_rng(4)
    x, y = (v.ravel() for v in np.meshgrid(-50.0 + 2.0 * np.arange(50), 1.0 + np.arange(40)))
    is_lit = rng.random(2000) < 0.6
    low = np.stack([x, y, np.full(2000, 0.02)], axis=1)
    around = np.array([(0, 0, 0), (1, 0, 0), (1, 0.6, 0), (0, 0.6, 0)])
    windows = low[:, None] + around
    dark = Material(base_color=(0.05, 0.05, 0.05), specular=0.0)
    meshes = [Mesh(quad(), MATT, at(0, 0, 15, 120, 1, 40))]
    for own, material in ((windows[is_lit], GLOW), (windows[~is_lit], dark)):
        first = 4 * np.arange(len(own))[:, None]
        triangles = np.concatenate([first + np.array(k) for k in ((0, 1, 2), (0, 2, 3))])
        positions = own.reshape(-1, 3).astype(np.float32)
        meshes.append(Mesh(Geometry(positions, triangles.astype(np.uint32)), material))
    camera = Camera((0, 12, 30), (0, 0, 12), fov_y_deg=60)
    return Scene(meshes=tuple(meshes), camera=camera), windows[is_lit]


def string() -> tuple[Scene, np.ndarray]:
    """A hundred bulbs of 6 cm across on a sagging cable of 12 m."""
    t = np.linspace(0.0, 1.0, 100)
    places = np.stack([-6 + 12 * t, 2.6 - np.sin(np.pi * (4 * t % 1.0)), -3 + 4 * t], axis=1)
    bulbs = [Mesh(sphere(), GLOW, at(*p, 0.06, 0.06, 0.06)) for p in places]
    floor = Mesh(quad(), MATT, at(0, 0, 0, 14, 1, 10))
    return Scene(meshes=(floor, *bulbs), camera=Camera((0, 6, 7), (0, 0, 0))), places


def floor_light(scene: Scene, camera_rays) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) of the floor, every seventh pixel, and their direct light."""
    image = render(scene, "direct", SIZE, samples=1, settings=SMALL)
    rays = camera_rays(scene.camera, SIZE)
    points = np.array(scene.camera.position) + rays * image.layers["depth"][..., None]
    is_floor = (np.abs(points[..., 1]) < 0.01) & (image.layers["depth"] > 0.0)
    return points[is_floor][::7], image.layers["direct"][is_floor][::7]


def lambert(polygons: np.ndarray) -> float:
    """Irradiance from above of polygons (n, 4, 3) of radiance 1, none of which the horizon cuts."""
    a = polygons / np.linalg.norm(polygons, axis=2, keepdims=True)
    b = np.roll(a, -1, axis=1)
    normal = np.cross(a, b)
    sine = np.linalg.norm(normal, axis=2)
    sums = (np.arctan2(sine, (a * b).sum(axis=2)) * normal[..., 1] / sine).sum(axis=1)
    return 0.5 * float(np.abs(sums).sum())


def off(found: np.ndarray, irradiance: np.ndarray) -> tuple[float, float]:
    """Energy ratio and relative L2 beside Lambert under that irradiance of radiance 1."""
    expected = irradiance[:, None] * 0.6 / np.pi * np.array(GLOW.emission)
    difference = np.linalg.norm(found - expected) / np.linalg.norm(expected)
    return float(found.sum() / expected.sum()), float(difference)


def test_two_thousand_windows_light_the_street_as_all_of_them_do(camera_rays) -> None:
    scene, windows = facade()
    points, found = floor_light(scene, camera_rays)
    before = points[:, 2] > 0.5  # what lies behind the windows gets none of their light
    points, found = points[before], found[before]
    assert len(points) > 50
    irradiance = np.array([lambert(windows - p) for p in points])
    energy, difference = off(found, irradiance)
    # Groups of windows are polygons as bright as they are together: 4 to 9 % off within 8 m of the
    # wall, 1.5 % beyond. Measured: 1.013, .034.
    assert energy == pytest.approx(1.0, abs=0.02)
    assert difference < 0.045


def bulbs_irradiance(bulbs: np.ndarray, radius: float) -> float:
    """Irradiance from above of balls (n, 3) of radiance 1, which hide one another.

    The shares that are seen are those of disks' points, 32 on a spiral, each a ray.
    """
    turn = np.arange(32) + 0.5
    spread, around = np.sqrt(turn / 32), turn * np.pi * (3.0 - np.sqrt(5.0))
    total = 0.0
    for k, bulb in enumerate(bulbs):
        side = np.cross(bulb, (0.0, 1.0, 0.0))
        side /= np.linalg.norm(side)
        up = np.cross(side, bulb / np.linalg.norm(bulb))
        offsets = np.outer(np.cos(around), side) + np.outer(np.sin(around), up)
        rays = bulb + radius * spread[:, None] * offsets
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        others = np.delete(bulbs, k, 0)
        along = others @ rays.T
        apart = (others**2).sum(axis=1)[:, None] - along**2
        is_hidden = ((apart < radius**2) & (along < np.linalg.norm(bulb))).any(axis=0)
        total += sphere_irradiance(bulb[[0, 2, 1]], radius) * (1.0 - is_hidden.mean())
    return total


@pytest.mark.slow
def test_a_hundred_bulbs_light_the_floor_as_all_of_them_do(camera_rays) -> None:
    scene, places = string()
    points, found = floor_light(scene, camera_rays)
    assert len(points) > 50
    irradiance = np.array([bulbs_irradiance(places - p, 0.03) for p in points])
    energy, difference = off(found, irradiance)
    # Measured: .995, .015; without the bulbs between the others and the floor .974, .058.
    assert energy == pytest.approx(1.0, abs=0.01)
    assert difference < 0.02
