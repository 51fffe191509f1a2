"""Volumes on grids of ordinates in a medium that a lattice solves: how its fog lights them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import (
    Camera,
    DirectionalLight,
    Material,
    Medium,
    Mesh,
    PointLight,
    Scene,
    Volume,
)
from airlight.scene.shapes import box
from airlight.techniques import auto

SIZE = (24, 18)
SETTINGS = {"grid": 8, "resolution": 16, "shadow_resolution": 128, "lamp_resolution": 128}
BOUNDS = ((-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))
SUN = DirectionalLight((0.0, -1.0, 0.0), (3.0, 3.0, 3.0))
CAMERA = Camera((0.0, 0.0, 1.5), (0.0, 0.0, 0.0), fov_y_deg=20.0)


@pytest.fixture(autouse=True)
def _by_ordinates(monkeypatch: pytest.MonkeyPatch) -> None:
    """Volumes that cells resolve would be part of the fog's lattice."""
    monkeypatch.setattr(auto, "_are_resolved", lambda scene: False)


def puff(per_m: float, albedo: float, side: float, turned_deg: float = 0.0) -> Volume:
    """A cube about the origin, turned about z."""
    h, angle = 0.5 * side, np.radians(turned_deg)
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return Volume(
        (per_m,) * 3,
        np.ones((4, 4, 4), np.float32),
        bounds=((-h,) * 3, (h,) * 3),
        albedo=(albedo,) * 3,
        world_from_volume=matrix,
    )


def scattered(scene: Scene, **settings: object) -> np.ndarray:
    """What media scatter, in the middle of the image."""
    image = render(scene, "auto", SIZE, settings={**SETTINGS, **settings}, samples=1)
    layers = [image.layers[k] for k in ("single_scatter", "multiple_scatter") if k in image.layers]
    return np.asarray(sum(layers)[6:12, 9:15].mean(axis=(0, 1)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("light", "path_m"), [(SUN, 2.0), (PointLight((0.0, 0.9, 0.0), (1.0, 1.0, 1.0)), 0.9)]
)
def test_black_fog_attenuates_light_on_its_way_to_a_volume(light, path_m):
    """By the light's and the eye's path through the fog, which without it is nothing."""
    sigma = np.array([0.2, 0.5, 0.9])
    fog = Medium(tuple(sigma), (0.0,) * 3, (0.0,) * 3, BOUNDS)
    clear = Scene((), (light,), camera=CAMERA, volumes=(puff(1.0, 0.1, 0.1, 30.0),))
    ratio = scattered(replace(clear, medium=fog)) / scattered(clear)
    np.testing.assert_allclose(ratio, np.exp(-sigma * (path_m + 1.5)), rtol=0.03)


def with_black_cube(scene: Scene) -> Scene:
    """A small one in a corner, far from volume and light."""
    place = np.diag([0.05, 0.05, 0.05, 1.0])
    place[:3, 3] = (1.9, -1.9, 1.9)
    black = Material(base_color=(0.0, 0.0, 0.0), specular=0.0)
    return replace(scene, meshes=(Mesh(box(), black, place),))


def test_white_fog_lights_a_volume_whether_there_are_surfaces_or_not():
    fog = Medium((0.3,) * 3, (1.0,) * 3, (0.0,) * 3, BOUNDS)
    bare = Scene((), (SUN,), camera=CAMERA, medium=fog, volumes=(puff(8.0, 1.0, 0.6),))
    # Lattices of the same cells.
    same = {"bounds": (-2.0, -2.0, -2.0, 2.0, 2.0, 2.0)}
    alone = scattered(bare, **same)
    np.testing.assert_allclose(scattered(with_black_cube(bare), **same), alone, rtol=0.01)
    # What the fog scatters onto the volume, of its light.
    dark = replace(fog, albedo=(0.0,) * 3)
    assert np.all(scattered(replace(bare, medium=dark)) < 0.8 * alone)
