"""The environment's light in air against quadrature, and through it on surfaces."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from airlight.reference.quadrature import box_path, henyey_greenstein, panels
from airlight.rendering import render
from airlight.scene import Camera, Medium, Mesh, Scene
from airlight.scene.environment import Environment
from airlight.scene.shapes import quad

BOX = ((-2.0, -1.0, -2.0), (2.0, 2.0, 2.0))
SIGMA_T, ALBEDO = np.array([0.1, 0.4, 0.9]), np.array([0.9, 0.6, 1.0])
SIZE = (12, 9)
EYE = (0.6, 0.4, 5.5)


def foggy(g: float, *meshes: Mesh) -> Scene:
    """A box of air under a white sky; without meshes the lattice lies over the box."""
    return Scene(
        meshes=meshes,
        medium=Medium(tuple(SIGMA_T), tuple(ALBEDO), (g, g, g), BOX),
        environment=Environment(),
        camera=Camera(EYE, (0.0, 0.2, -1.0), fov_y_deg=45),
    )


def spread(count: int) -> np.ndarray:
    """Unit vectors (count, 3), evenly (Fibonacci)."""
    k = np.arange(count) + 0.5
    y, turn = 1.0 - 2.0 * k / count, k * np.pi * (3.0 - np.sqrt(5.0))
    r = np.sqrt(1.0 - y * y)
    return np.stack([r * np.cos(turn), y, r * np.sin(turn)], axis=1)


def scattered_once(
    directions: np.ndarray, g: float, sigma_t: np.ndarray, albedo: np.ndarray
) -> np.ndarray:
    """(H, W, 3): what air under a sky of radiance 1 scatters to the eye."""
    eye = np.array(EYE)
    entry, leave = box_path(eye, directions, BOX)
    x, w = panels(12, 2)
    t = entry[..., None] + (leave - entry)[..., None] * x
    p = eye + t[..., None] * directions[..., None, :]
    incoming = spread(400)
    phase = henyey_greenstein(directions @ incoming.T, g)
    phase /= phase.sum(axis=-1, keepdims=True)
    out = box_path(p[..., None, :], incoming, BOX)[1]
    open_sky = np.einsum("hwn,hwtnc->hwtc", phase, np.exp(-out[..., None] * sigma_t))
    eye_depth = (t - entry[..., None])[..., None] * sigma_t
    total = (w[..., None] * open_sky * np.exp(-eye_depth)).sum(axis=-2)
    return np.asarray(total * (leave - entry)[..., None] * sigma_t * albedo)


@pytest.mark.parametrize("g", [0.0, 0.6])
def test_air_under_a_white_sky(gpu: Any, look: Any, g: float) -> None:
    scene = foggy(g)
    settings = {"march_resolution": "full", "resolution": 16, "steps_per_cell": 2.0}
    image = render(scene, "single", SIZE, samples=1, settings=settings)
    want = scattered_once(look(scene, SIZE).directions(), g, SIGMA_T, ALBEDO)
    got = image.layers["single_scatter"]
    for c in range(3):
        assert np.linalg.norm(got[..., c] - want[..., c]) < 0.08 * np.linalg.norm(want[..., c])
    assert abs(got.sum() / want.sum() - 1.0) < (0.03 if g == 0.0 else 0.06)


def test_dense_air_that_scatters_forwards(gpu: Any, look: Any) -> None:
    """Eight mean free paths through it: three bands of the phase function, not two, are enough."""
    scene = foggy(0.6)
    dense = dataclasses.replace(scene, medium=Medium((2.0,) * 3, (1.0,) * 3, (0.6,) * 3, BOX))
    settings = {"march_resolution": "full", "steps_per_cell": 2.0}
    image = render(dense, "single", SIZE, samples=1, settings=settings)
    want = scattered_once(look(scene, SIZE).directions(), 0.6, np.full(3, 2.0), np.ones(3))
    got = image.layers["single_scatter"]
    # Measured .058 and 1.056; with two bands .141 and .865.
    assert np.linalg.norm(got - want) < 0.08 * np.linalg.norm(want)
    assert abs(got.sum() / want.sum() - 1.0) < 0.08


def test_a_floor_under_air_gets_less_of_the_sky(gpu: Any) -> None:
    """Straight down e^-x of it arrives, from the horizon nothing: 2 E3(x) of a white sky.

    The floor shades itself where texels of the sky's maps are metres wide; here they are not.
    """
    matrix = np.diag([30.0, 1.0, 30.0, 1.0])
    matrix[1, 3] = -1.0
    floor = Mesh(quad(), world_from_object=matrix)
    wide = ((-30.0, -1.001, -30.0), (30.0, 2.0, 30.0))
    camera = Camera((0.0, 1.0, 0.1), (0.0, -1.0, 0.0), fov_y_deg=30)
    sky = Environment()
    air = Medium((0.2,) * 3, (0.0,) * 3, bounds=wide)
    settings = {"ambient_occlusion": False, "bounds": (-4.0, -1.5, -4.0, 4.0, 2.5, 4.0)}
    clear, hazy = (
        render(
            Scene(meshes=(floor,), medium=medium, environment=sky, camera=camera),
            "single",
            (8, 6),
            samples=1,
            settings=settings,
        ).layers["direct"]
        for medium in (None, air)
    )
    mu = (np.arange(2000) + 0.5) / 2000
    share = float((2.0 * mu * np.exp(-0.6 / mu)).mean())
    seen = np.exp(-0.2 * 2.0)
    assert abs(hazy.mean() / clear.mean() / (share * seen) - 1.0) < 0.05
