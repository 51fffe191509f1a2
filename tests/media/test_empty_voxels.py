"""Marching steps over what grids leave empty, and draws the same."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.empty_voxels import REACH
from airlight.media import atlas
from airlight.rendering import render
from airlight.scene import Camera, DirectionalLight, Scene, Volume
from airlight.scene.emission import Emission

SIZE = (40, 32)


def puffs(*, glow: bool = False) -> Scene:
    """Balls far apart in a large grid, another grid across it."""
    z, y, x = np.meshgrid(*[np.arange(48) + 0.5] * 3, indexing="ij")
    density = np.zeros((48, 48, 48), np.float32)
    for at in ((10, 12, 14), (34, 30, 20), (20, 38, 40)):
        away = np.sqrt((z - at[0]) ** 2 + (y - at[1]) ** 2 + (x - at[2]) ** 2)
        density += np.clip(5.0 - away, 0.0, 1.0).astype(np.float32)
    # Fire beside the smoke, where there is none.
    fire = Emission((3.0, 2.0, 1.0), np.roll(density, 16, axis=2)) if glow else None
    grids = Volume(6.0, density, bounds=((-1, 0, -1), (1, 2, 1)), emission=fire)
    low = density[12:36, 12:36, 12:36].copy()
    turned = np.eye(4)
    turned[:3, :3] = np.array([[0.8, 0.0, 0.6], [0.0, 1.0, 0.0], [-0.6, 0.0, 0.8]])
    other = Volume(4.0, low, bounds=((-1, 0.2, -1), (1, 1.8, 1)), world_from_volume=turned)
    return Scene(
        camera=Camera((0.3, 1.2, 4.5), (0.0, 1.0, 0.0), fov_y_deg=32.0),
        lights=(DirectionalLight((0.3, -1.0, -0.4), (3.0, 2.0, 1.0)),),
        volumes=(grids, other),
    )


@pytest.mark.parametrize("glow", [False, True])
def test_what_is_empty_is_stepped_over(monkeypatch: pytest.MonkeyPatch, glow: bool) -> None:
    """Steps begin elsewhere, half a voxel off at most: .02 covers the midpoint rule's error."""
    settings = {"grid": 8, "march": "full"}
    drawn = render(puffs(glow=glow), "pop", SIZE, settings=settings, samples=1)
    monkeypatch.setattr(atlas, "MOST_WITH_DISTANCES", 0)
    every = render(puffs(glow=glow), "pop", SIZE, settings=settings, samples=1)
    for name in ("scattered", "transmittance"):
        one, other = drawn.layers[name], every.layers[name]
        if name == "transmittance":
            one, other = 1.0 - one, 1.0 - other
        assert other.mean() > 0.01
        assert not np.array_equal(one, other)
        assert one.mean() == pytest.approx(other.mean(), rel=0.01)
        assert np.linalg.norm(one - other) < 0.03 * np.linalg.norm(other)


def test_the_shader_reaches_as_far(shader_text: str) -> None:
    assert f"const EMPTY_REACH = {REACH};" in shader_text


@pytest.fixture
def shader_text() -> str:
    from importlib.resources import files

    return (files("airlight") / "wgsl" / "media_ray.wgsl").read_text()
