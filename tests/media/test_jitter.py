"""The jittered scheme against the exact one, and density grids against a box of even air."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.lighting.lights import Lights
from airlight.media.media_image import MediaImage
from airlight.media.settings import MediaSettings
from airlight.scene import (
    Camera,
    DirectionalLight,
    Light,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    Volume,
)

SIZE = (40, 28)
BOX = ((-2.0, -1.5, -2.0), (2.0, 2.0, 2.0))
RGB = (3.0, 2.0, 1.0)
LIGHTS: dict[str, Light] = {
    "directional": DirectionalLight((0.35, -0.8, -0.3), RGB),
    "point": PointLight((0.3, 1.2, -0.2), RGB),
    "spot": SpotLight((0.3, 1.8, -0.2), (-0.2, -1.0, 0.1), RGB, 30.0, 70.0),
}


def fog(square: Callable[..., Mesh], light: Light) -> Scene:
    """A box of air, and a sheet over its left half."""
    medium = Medium((0.15, 0.5, 1.2), (0.9, 0.6, 1.0), (0.45, 0.45, 0.45), BOX)
    sheet = square((-1.5, 0.6, 0.0), (1.5, 0, 0), (0, 0, -1.5))
    camera = Camera((0.6, 0.4, 5.5), (0.0, 0.2, -1.0), fov_y_deg=45)
    return Scene(meshes=(sheet,), lights=(light,), medium=medium, camera=camera)


def as_grid(scene: Scene) -> Scene:
    """The same air as a density grid of ones."""
    m = scene.medium
    assert m is not None
    volume = Volume(m.sigma_t, np.ones((7, 6, 8), np.float32), "grid", BOX, m.albedo, m.g)
    return dataclasses.replace(scene, medium=None, volumes=(volume,))


def single(gpu: Gpu, seen: Any, owned: Callable[[Any], Any], **settings: Any) -> np.ndarray:
    scene = seen.scene
    low, high = (np.array(corner) for corner in BOX)
    lights = owned(Lights(gpu, scene.lights, None, 512, 512))
    lights.encode(seen.commands, seen.meshes, scene.lights, None, low, high)
    given = MediaSettings(shaft_resolution="full", march_resolution="full", **settings)
    air = owned(MediaImage(gpu, scene, SIZE, lights, given))
    air.solve(seen.commands, scene, low, high)
    air.encode(seen.commands, seen.view, lights)
    return np.asarray(seen.read(air.single_scatter))


def l2(a: np.ndarray, b: np.ndarray) -> float:
    """Of what is seen: the peak at a lamp, a pixel wide, is compressed."""
    a, b = a / (a + b.mean()), b / (b + b.mean())
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_both_schemes_agree(
    gpu: Gpu, look: Any, owned: Any, square: Callable[..., Mesh], light: Light
) -> None:
    seen = look(fog(square, light), SIZE)
    exact = single(gpu, seen, owned, shafts="minmax")
    jittered = single(gpu, seen, owned, shafts="jitter", shaft_steps=64)
    # At 40 x 28 pixels the scheme's blur is as wide as shafts are, so the exact one gets it too.
    padded = np.pad(exact, ((1, 2), (1, 2), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, (4, 4), axis=(0, 1))
    assert l2(jittered, windows.mean(axis=(-2, -1))) < 0.12
    assert jittered.sum() == pytest.approx(exact.sum(), rel=0.02)


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_a_grid_of_ones_is_even_air(
    gpu: Gpu, look: Any, owned: Any, square: Callable[..., Mesh], light: Light
) -> None:
    scene = fog(square, light)
    even = single(gpu, look(scene, SIZE), owned, shafts="jitter", shaft_steps=48)
    grid = single(gpu, look(as_grid(scene), SIZE), owned, shafts="jitter", shaft_steps=48)
    assert l2(grid, even) < 1e-4
