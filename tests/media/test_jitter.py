"""The jittered scheme against the exact one; density grids against a homogeneous box."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

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

from .shaft_setups import BOX, RGB, compressed_l2

SIZE = (40, 28)
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


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_both_schemes_agree(
    look: Any, scattered_once: Any, square: Callable[..., Mesh], light: Light
) -> None:
    seen = look(fog(square, light), SIZE)
    exact = scattered_once(seen, shafts="minmax")
    jittered = scattered_once(seen, shafts="jitter", shaft_steps=64)
    # At 40 x 28 pixels the scheme's blur is as wide as shafts are, so the exact one gets it too.
    padded = np.pad(exact, ((1, 2), (1, 2), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, (4, 4), axis=(0, 1))
    assert compressed_l2(jittered, windows.mean(axis=(-2, -1))) < 0.12
    assert jittered.sum() == pytest.approx(exact.sum(), rel=0.02)


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_a_grid_of_ones_is_a_homogeneous_medium(
    look: Any, scattered_once: Any, square: Callable[..., Mesh], light: Light
) -> None:
    scene = fog(square, light)
    even = scattered_once(look(scene, SIZE), shafts="jitter", shaft_steps=48)
    grid = scattered_once(look(as_grid(scene), SIZE), shafts="jitter", shaft_steps=48)
    assert compressed_l2(grid, even) < 1e-4
