"""Colours of a volume in its file: which are read, where they lie, mistakes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.reference.mitsuba_scene import write_mitsuba
from airlight.scene import Scene, Volume
from airlight.scene.coefficients import albedo_of, sigma_t_of
from airlight.scene.io import load
from airlight.scene.io.toml_text import scene_text

BOX = ((-1.0, 0.0, -1.0), (1.0, 3.0, 1.0))
RNG = np.random.default_rng(2)
DENSITY = RNG.random((3, 4, 5), dtype=np.float32)
COLOURS = RNG.random((3, 4, 5, 3), dtype=np.float32)


def scene(tmp_path, keys: str, **arrays: np.ndarray):
    arrays.setdefault("density", DENSITY)
    arrays = {name: grid for name, grid in arrays.items() if grid is not None}
    np.savez(tmp_path / "dye.npz", bounds=np.array(BOX), **arrays)
    (tmp_path / "scene.toml").write_text(f'[[volume]]\nfile = "dye.npz"\n{keys}\n')
    return load(tmp_path / "scene.toml").volumes[0]


def test_colours_are_the_albedo(tmp_path):
    keys = 'sigma_t = 2\nalbedo = 0.5\nalbedo_grid = "Cd"\ng_grid = "g"'
    volume = scene(tmp_path, keys, Cd=COLOURS, g=0.5 * DENSITY)
    assert volume.sigma_t == (2.0,) * 3
    assert volume.albedo == (0.5,) * 3
    np.testing.assert_array_equal(volume.albedo_grid, COLOURS)
    np.testing.assert_array_equal(volume.g_grid[..., 1], 0.5 * DENSITY)
    np.testing.assert_array_equal(volume.density, DENSITY)


@pytest.mark.parametrize("has_density", [True, False])
def test_scattering_and_absorption_by_voxel(tmp_path, has_density):
    """Of a file without a density, too; a number multiplies its grid, or the density."""
    keys = 'sigma_s = [1, 2, 3]\nsigma_s_grid = "s"\nsigma_a_grid = "a"'
    arrays = {"s": COLOURS, "a": DENSITY, "density": DENSITY if has_density else None}
    volume = scene(tmp_path, keys, **arrays)
    sigma_t = COLOURS * [1, 2, 3] + DENSITY[..., None]
    np.testing.assert_allclose(volume.density[..., None] * volume.tint, sigma_t, rtol=1e-6)
    np.testing.assert_allclose(volume.albedo_grid, COLOURS * [1, 2, 3] / sigma_t, rtol=1e-5)
    if has_density:
        volume = scene(tmp_path, 'sigma_s_grid = "s"\nsigma_a = 3', **arrays)
        sigma_t = COLOURS + 3.0 * DENSITY[..., None]
        np.testing.assert_allclose(volume.density[..., None] * volume.tint, sigma_t, rtol=1e-6)


def test_a_file_on_its_own_has_its_colours(tmp_path):
    np.savez(tmp_path / "dye.npz", density=DENSITY, bounds=np.array(BOX), Cd=1.5 * COLOURS)
    opened = load(tmp_path / "dye.npz")
    np.testing.assert_array_equal(opened.volumes[0].albedo_grid, np.minimum(1.5 * COLOURS, 1.0))
    assert any('albedo_grid = "Cd"' in text and "cut off" in text for text in opened.warnings)


@pytest.mark.parametrize(
    ("keys", "arrays", "problem"),
    [
        ('sigma_t = 2\nalbedo_grid = "Cd"', {}, "has no array 'Cd'"),
        ('sigma_t = 2\nalbedo_grid = "c"', {"c": 2.0 * COLOURS}, r"must lie in \[0, 1\]"),
        ('sigma_t = 2\nalbedo_grid = "c"', {"c": COLOURS * np.inf}, "infinite values"),
        ('sigma_t = 2\nalbedo_grid = "c"', {"c": COLOURS[..., :2]}, "has one or three"),
        ('sigma_t = 2\ng = 0.5\ng_grid = "c"', {"c": DENSITY}, "has g and g_grid"),
        ('sigma_s_grid = "c"', {"c": -DENSITY}, "sigma_s must lie in"),
        ('sigma_t = 2\nsigma_s_grid = "c"', {"c": DENSITY}, "mixes sigma_s with sigma_t"),
        ('albedo_grid = "c"', {"c": DENSITY}, "has no sigma_t"),
    ],
)
def test_one_message_each(tmp_path, keys, arrays, problem):
    with pytest.raises(SceneError, match=problem) as raised:
        scene(tmp_path, keys, **arrays)
    assert "scene.toml" in str(raised.value) or "dye.npz" in str(raised.value)


def test_a_shape_has_no_colours_by_voxel(tmp_path):
    text = '[[volume]]\nshape = "sphere"\nsigma_t = 2\nalbedo_grid = "Cd"\n'
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(SceneError, match="albedo_grid belongs to a file, not to a shape"):
        load(tmp_path / "scene.toml")


def test_mitsuba_takes_colours_and_gives_them_back(tmp_path):
    """`gridvolume` as sigma_t and albedo, and g as the weight of a `blendphase`."""
    volume = Volume(
        (2.0, 3.0, 4.0),
        DENSITY,
        bounds=BOX,
        tint=0.2 + 0.8 * COLOURS,
        albedo_grid=COLOURS[::-1],
        g_grid=0.2 + 0.4 * DENSITY,
    )
    write_mitsuba(Scene(volumes=(volume,)), tmp_path / "dye.xml")
    (again,) = load(tmp_path / "dye.xml").volumes
    wanted, got = (v.density[..., None] * np.array(v.sigma_t) * v.tint for v in (volume, again))
    np.testing.assert_allclose(got, wanted, rtol=1e-4)
    np.testing.assert_allclose(again.albedo_grid, volume.albedo_grid, atol=1e-4)
    np.testing.assert_allclose(again.g_grid, volume.g_grid, atol=1e-4)


@pytest.mark.parametrize(
    ("keys", "keeps_albedo"),
    [
        ('sigma_t_grid = "s"', True),
        ('sigma_t_grid = "s"\nalbedo = 0.5', True),
        ('sigma_t = [1, 2, 3]\nsigma_t_grid = "s"\nalbedo_grid = "c"\nalbedo = 0.9', True),
        ('sigma_s_grid = "s"\nsigma_a_grid = "a"', False),
    ],
)
def test_a_changed_albedo_comes_back_beside_grids_of_extinction(tmp_path, keys, keeps_albedo):
    """Or is said, where the file's sigma_s and sigma_a leave no place for it."""
    grids = {"s": COLOURS, "a": DENSITY, "c": COLOURS}
    source = tmp_path / "scene.toml"
    changed = replace(scene(tmp_path, keys, **grids), albedo=(0.2, 0.4, 0.6), sigma_t=(3.0,) * 3)
    before = load(source)
    text = scene_text(replace(before, volumes=(changed,)), before, str(source), tmp_path)
    source.write_text(text)
    (back,) = load(source).volumes
    np.testing.assert_allclose(sigma_t_of(back), sigma_t_of(changed), rtol=1e-5)
    assert ("changed albedo" in text) != keeps_albedo
    if keeps_albedo:
        np.testing.assert_allclose(
            np.broadcast_to(albedo_of(back), COLOURS.shape),
            np.broadcast_to(albedo_of(changed), COLOURS.shape),
            rtol=1e-5,
        )
