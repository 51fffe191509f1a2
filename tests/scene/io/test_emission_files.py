"""Emission and temperature grids beside a density: which are read, where they lie, mistakes."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.maths import blackbody
from airlight.scene.io import load
from airlight.scene.io.emission_files import on_one_grid
from airlight.scene.io.volumes import GridValues, VolumeGrid

BOX = ((-1.0, 0.0, -1.0), (1.0, 3.0, 1.0))


def scene(tmp_path, keys: str, **arrays: np.ndarray):
    rng = np.random.default_rng(2)
    density = rng.random((3, 4, 5), dtype=np.float32)
    np.savez(tmp_path / "fire.npz", density=density, bounds=np.array(BOX), **arrays)
    text = f'[[volume]]\nfile = "fire.npz"\nsigma_t = 2\n{keys}\n'
    (tmp_path / "scene.toml").write_text(text)
    return load(tmp_path / "scene.toml").volumes[0]


def test_temperatures_are_black_bodies(tmp_path) -> None:
    celsius = np.linspace(600.0, 1800.0, 60, dtype=np.float32).reshape(3, 4, 5)
    celsius[0, 0, 0] = 0.0  # what a file holds where there is nothing
    keys = 'temperature_grid = "t"\ntemperature_offset = -273.15\nemission = [2, 2, 1]'
    volume = scene(tmp_path, keys, t=celsius)
    assert volume.emission.radiance == (2.0, 2.0, 1.0)
    expected = blackbody.rec709(celsius.astype(np.float64) + 273.15)
    expected[0, 0, 0] = 0.0
    np.testing.assert_allclose(volume.emission.values, expected, rtol=2e-3, atol=1e-6)


def test_a_flame_grid_is_multiplied(tmp_path) -> None:
    flame = np.random.default_rng(3).random((3, 4, 5), dtype=np.float32)
    volume = scene(tmp_path, 'emission_grid = "flame"\nemission = 5', flame=flame)
    np.testing.assert_array_equal(volume.emission.grid, flame)
    assert volume.emission.radiance == (5.0, 5.0, 5.0)
    colours = np.stack([flame, 0.5 * flame, 0.0 * flame], axis=-1)
    volume = scene(tmp_path, 'emission_grid = "Cd"', Cd=colours)
    np.testing.assert_array_equal(volume.emission.values, colours)
    assert volume.emission.radiance == (1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("keys", "arrays", "problem"),
    [
        ('emission_grid = "flame"', {}, "has no array 'flame'"),
        ('temperature_grid = "t"', {"t": np.full((3, 4, 5), np.inf)}, "infinite"),
        ('temperature_grid = "t"', {"t": np.full((3, 4, 5), -5.0)}, "negative: down to -5 K"),
        ('emission_grid = "t"', {"t": np.full((3, 4, 5), -5.0)}, "negative (down to -5)"),
        ('temperature_grid = "t"', {"t": np.ones((3, 4, 5, 3))}, "a temperature has one"),
        ('emission_grid = "t"', {"t": np.ones((3, 4, 5, 2))}, "colours have three"),
        ('emission_grid = "t"', {"t": np.ones((0, 4, 5))}, "is empty"),
        ('emission_grid = "t"\ntemperature_grid = "t"', {}, "and a temperature_grid"),
        ("temperature_scale = 2", {}, "belongs to a temperature_grid"),
        ("emission = -1", {}, "negative"),
    ],
)
def test_one_message_each(tmp_path, keys, arrays, problem) -> None:
    with pytest.raises(SceneError) as raised:
        scene(tmp_path, keys, **arrays)
    assert problem in str(raised.value)
    assert "scene.toml" in str(raised.value) or "fire.npz" in str(raised.value)


def test_a_shape_has_no_grids(tmp_path) -> None:
    text = '[[volume]]\nshape = "sphere"\nsigma_t = 2\nemission_grid = "flame"\n'
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(SceneError, match="belongs to a file, not to a shape"):
        load(tmp_path / "scene.toml")


def test_a_flame_beyond_the_smoke_makes_the_box_larger() -> None:
    """Grids of a .vdb have boxes of their own; voxels of other sizes are resampled."""
    smoke = VolumeGrid(np.ones((4, 4, 4), np.float32), ((0.0, 0.0, 0.0), (4.0, 4.0, 4.0)))
    flame = np.random.default_rng(4).random((3, 3, 3), dtype=np.float32)
    same_voxels = GridValues(flame, ((-1.0, 2.0, 1.0), (2.0, 5.0, 4.0)), np.eye(4))
    grown, glow = on_one_grid(smoke, same_voxels)
    assert grown.bounds == ((-1.0, 0.0, 0.0), (4.0, 5.0, 4.0))
    assert grown.density.shape == glow.shape == (4, 5, 5)
    np.testing.assert_allclose(glow[1:4, 2:5, 0:3], flame, rtol=1e-6)
    assert glow.sum() == pytest.approx(flame.sum())
    assert grown.density.sum() == smoke.density.sum()
    # Voxels twice as fine: what there is in all stays, up to the rims.
    fine = GridValues(np.ones((8, 8, 8), np.float32), ((0.0,) * 3, (4.0,) * 3), np.eye(4))
    grown, glow = on_one_grid(smoke, fine)
    assert grown is smoke
    np.testing.assert_allclose(glow, 1.0, rtol=1e-6)
