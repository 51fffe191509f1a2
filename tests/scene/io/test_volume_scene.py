"""A density grid alone: whitish smoke in daylight, seen whole."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.exports.vdb import VdbGrid, vdb_bytes
from airlight.maths.blackbody import rec709
from airlight.scene.io import load
from airlight.scene.io.dense_grid import Optics
from airlight.scene.io.dense_part import dense_box
from airlight.scene.io.framing import framing_box
from airlight.scene.io.volume_scene import (
    DEPTH,
    FLAME,
    fitting_sigma_t,
    grid_volume,
    load_volume_scene,
)
from airlight.scene.io.volumes import VolumeGrid


def test_a_bare_grid_gets_a_camera_daylight_and_a_word_about_its_depth(tmp_path):
    density = np.zeros((4, 8, 6), np.float32)
    density[1:3, 2:6, 1:5] = 2.0
    np.save(tmp_path / "plume.npy", density)
    scene = load(tmp_path / "plume.npy")
    (volume,) = scene.volumes
    np.testing.assert_array_equal(volume.density, density)
    assert scene.name == "plume"
    assert len(scene.lights) == 1
    assert scene.environment is not None
    stops = scene.camera.exposure_stops
    assert stops is not None and stops < -2.0  # by the light that was added
    assert scene.camera == replace(framing_box(*dense_box(scene)), exposure_stops=stops)
    assert scene.warnings[-2] == (
        f"plume.npy says nothing about light: sigma_t = {volume.sigma_t[0]:g} m^-1 and albedo = "
        "0.9 were chosen; a scene file with [[volume]] sets them"
    )


def test_a_grid_is_chosen_by_its_name_and_channel(tmp_path):
    one, two = np.ones((2, 2, 2), np.float32), np.full((2, 2, 2, 3), (0, 4, 0), np.float32)
    np.savez(tmp_path / "a.npz", one=one, two=two)
    assert load(tmp_path / "a.npz", grid="two", channels="g").volumes[0].density.max() == 4
    with pytest.raises(SceneError, match=r"channels.*--channels"):
        load(tmp_path / "a.npz", grid="two")
    with pytest.raises(SceneError, match=r"'three'.*one, two"):
        load(tmp_path / "a.npz", grid="three")
    np.save(tmp_path / "a.npy", one)
    told = load(tmp_path / "a.npy", grid="smoke").warnings
    assert "a.npy: its only grid has no name: grid 'smoke' is left out" in told
    for path in ("a.glb", "a.toml"):
        with pytest.raises(SceneError, match="grid is for density grids"):
            load(tmp_path / path, grid="one")


def test_the_chosen_grid_is_no_fire_besides(tmp_path):
    np.savez(tmp_path / "a.npz", density=np.ones((2, 2, 2)), flame=np.full((2, 2, 2), 3.0))
    assert load(tmp_path / "a.npz").volumes[0].emission is not None
    assert load(tmp_path / "a.npz", grid="flame").volumes[0].emission is None


def test_its_denser_parts_are_six_deep():
    # 4 m of density .5 along x, the longest side
    density = np.full((3, 3, 3), 0.5, np.float32)
    assert fitting_sigma_t(density, ((0, 0, 0), (4, 1, 2))) == DEPTH / 2.0
    assert fitting_sigma_t(0.0 * density, ((0, 0, 0), (4, 1, 2))) == 1.0


def test_a_box_is_seen_whole():
    low, high = np.zeros(3), np.array([4.0, 2.0, 1.0])
    camera = framing_box(low, high)
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8).T
    offset = corners - camera.position
    forward = np.subtract(camera.target, camera.position)
    angles = np.arccos(offset @ forward / np.linalg.norm(offset, axis=1) / np.linalg.norm(forward))
    # Within the circle around a 4:3 image, and beyond the one in it.
    half = np.tan(np.radians(camera.fov_y_deg) / 2)
    assert np.arctan(half) < angles.max() < np.arctan(half * 5 / 3)


def test_air_is_seen_before_the_sky():
    """All of the view lies above the horizon: no ground is behind the box."""
    camera = framing_box(np.array([0.0, 300.0, 0.0]), np.array([3000.0, 2300.0, 3000.0]))
    x, y, z = np.subtract(camera.target, camera.position)
    assert np.degrees(np.arctan2(y, np.hypot(x, z))) > camera.fov_y_deg / 2


def test_a_damaged_grid_is_one_message(tmp_path):
    (tmp_path / "a.npy").write_bytes(b"no")
    with pytest.raises(SceneError, match=r"a\.npy"):
        load_volume_scene(tmp_path / "a.npy")


@pytest.mark.parametrize("unit", [1.0, 1000.0])
def test_a_bare_grid_with_temperatures_is_a_fire(tmp_path, unit):
    """In kelvin, or from 0 to 2 as simulations have them: the hottest voxels glow alike."""
    density = np.ones((4, 8, 6), np.float32)
    kelvin = np.linspace(0.0, 1900.0, density.size, dtype=np.float32).reshape(density.shape)
    np.savez(tmp_path / "fire.npz", density=density, temperature=kelvin / unit)
    scene = load(tmp_path / "fire.npz")
    emission = scene.volumes[0].emission
    expected = rec709(1900.0)
    np.testing.assert_allclose(emission.values[-1, -1, -1], expected, rtol=2e-3, atol=0.1)
    # A tenth of the two metres that a grid without a box is long.
    assert emission.peak * emission.radiance[0] * 0.2 == pytest.approx(FLAME, rel=0.01)
    assert 'temperature_grid = "temperature"' in " ".join(scene.warnings)
    assert ("temperature_scale" in " ".join(scene.warnings)) == (unit != 1.0)
    assert not scene.lights


def test_a_bare_grid_with_flames_glows_orange_and_a_cold_one_does_not(tmp_path):
    density = np.ones((4, 8, 6), np.float32)
    flame = np.random.default_rng(1).random(density.shape, dtype=np.float32)
    np.savez(tmp_path / "a.npz", density=density, flame=flame)
    emission = load(tmp_path / "a.npz").volumes[0].emission
    assert emission.radiance[0] > emission.radiance[1] > emission.radiance[2] > 0.0
    np.savez(tmp_path / "b.npz", density=density, flame=0.0 * flame)
    cold = load(tmp_path / "b.npz")
    assert cold.volumes[0].emission is None
    assert "no fire that is seen" in " ".join(cold.warnings)


SIZE = (4, 3, 2)  # z, y, x
"""Voxels of a plume whose height is its z axis: densest at the top."""


def plume() -> np.ndarray:
    return np.ones(SIZE, np.float32) * np.arange(1.0, 5.0, dtype=np.float32)[:, None, None]


def written_plume(folder: Path, suffix: str) -> Path:
    """The plume in a file of one kind, in a box (0, 0, 0) to (2, 3, 4)."""
    path = folder / f"plume{suffix}"
    values = plume()
    if suffix == ".npz":
        np.savez(path, density=values, bounds=[(0, 0, 0), (2, 3, 4)])
    elif suffix == ".vol":
        head = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, 2, 3, 4, 1, 0, 0, 0, 2, 3, 4)
        path.write_bytes(head + values.astype("<f4").tobytes())
    elif suffix == ".vdb":
        centred = np.eye(4)
        centred[:3, 3] = 0.5
        path.write_bytes(vdb_bytes([VdbGrid("density", values, centred, "")], {}))
    else:
        text = " ".join(f"{v:g}" for v in values.ravel())
        path.write_text(
            '<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">'
            '<ImageData WholeExtent="0 2 0 3 0 4" Origin="0 0 0" Spacing="1 1 1">'
            '<Piece Extent="0 2 0 3 0 4"><CellData Scalars="density">'
            f'<DataArray type="Float32" Name="density" format="ascii">{text}</DataArray>'
            "</CellData></Piece></ImageData></VTKFile>"
        )
    return path


@pytest.mark.parametrize("suffix", [".npz", ".vol", ".vdb", ".vti"])
def test_grids_of_another_unit_that_stand_on_z_are_placed_as_models_are(tmp_path, suffix):
    path = written_plume(tmp_path, suffix)
    plain, placed = load(path), load(path, up="z", scale=0.5)
    np.testing.assert_allclose(plain.bounds, [(0, 0, 0), (2, 3, 4)], atol=1e-6)
    np.testing.assert_allclose(placed.bounds, [(0, 0, -1.5), (1, 2, 0)], atol=1e-6)
    # The densest voxels, last along the file's z, are at the top.
    (volume,) = placed.volumes
    top = volume.world_from_volume @ [1.0, 1.5, volume.bounds[1][2], 1.0]
    assert top[1] == pytest.approx(2.0)
    # As deep at any scale, since the coefficient is chosen for the grid as it stands.
    assert volume.sigma_t[0] == pytest.approx(2.0 * plain.volumes[0].sigma_t[0], rel=0.05)
    # As the keys of a scene file have it.
    (tmp_path / "a.toml").write_text(
        f'[[volume]]\nfile = "{path.name}"\nsigma_t = 1\nup = "z"\nscale = 0.5\n'
    )
    of_keys = load(tmp_path / "a.toml").volumes[0]
    np.testing.assert_allclose(of_keys.world_from_volume, volume.world_from_volume)
    assert of_keys.bounds == volume.bounds


def test_a_turned_grid_fills_the_box_that_a_scene_file_says(tmp_path):
    np.save(tmp_path / "a.npy", plume())
    (tmp_path / "a.toml").write_text(
        '[[volume]]\nfile = "a.npy"\nsigma_t = 1\nup = "z"\nbounds = [[1, 2, 3], [2, 6, 6]]\n'
    )
    scene = load(tmp_path / "a.toml")
    np.testing.assert_allclose(scene.bounds, [(1, 2, 3), (2, 6, 6)], atol=1e-9)
    (volume,) = scene.volumes
    # Voxels are as long as they are: the file's z, four of them, runs along the four metres of y.
    np.testing.assert_allclose(np.subtract(*volume.bounds[::-1]), (1, 3, 4))


def test_what_a_grid_without_a_box_fills_is_told_as_it_was_before(tmp_path):
    np.save(tmp_path / "a.npy", plume())
    told = load(tmp_path / "a.npy", scale=10.0).warnings[0]
    assert told.endswith("it fills 1 x 1.5 x 2 m around the origin, before it is placed")
    assert load(tmp_path / "a.npy").warnings[0].endswith("around the origin")


def test_what_units_say_is_per_metre_at_any_scale():
    optics = Optics(0.03, 1.0, 0.85, "liquid water")
    grid = VolumeGrid(plume(), ((0, 0, 0), (2, 3, 4)), optics=optics)
    volume, _ = grid_volume(grid, Path("cloud.npy"), np.diag([100.0, 100.0, 100.0, 1.0]))
    assert volume.sigma_t == (0.03,) * 3
    assert volume.world_from_volume[0, 0] == 100.0


def test_a_turned_box_has_the_depth_of_its_place(tmp_path):
    """A grid whose file turns it lies in voxels: its sides are as long as the matrix makes them."""
    turned = np.array([[0, 0.1, 0, 0], [-0.1, 0, 0, 0], [0, 0, 0.1, 0], [0, 0, 0, 1.0]])
    path = tmp_path / "a.vdb"
    path.write_bytes(
        vdb_bytes([VdbGrid("density", np.ones((9, 9, 9), np.float32), turned, "")], {})
    )
    scene = load(path)
    depth = scene.volumes[0].sigma_t[0] * 0.9
    assert depth == pytest.approx(DEPTH, rel=0.05)


def test_a_fire_is_as_bright_at_any_scale(tmp_path):
    flame = np.random.default_rng(1).random(SIZE, dtype=np.float32)
    np.savez(tmp_path / "a.npz", density=plume(), flame=flame)
    one, ten = (load(tmp_path / "a.npz", scale=s).volumes[0].emission for s in (1.0, 10.0))
    np.testing.assert_allclose(one.radiance, np.multiply(ten.radiance, 10.0), rtol=0.02)


def test_a_scene_file_and_info_keep_how_a_grid_lies(tmp_path, capsys):
    path, out = written_plume(tmp_path, ".npz"), tmp_path / "out.toml"
    assert run(["convert", str(path), str(out), "--up", "z", "--scale", "0.5"]) == 0
    back, asked = load(out).volumes[0], load(path, up="z", scale=0.5).volumes[0]
    np.testing.assert_allclose(back.world_from_volume, asked.world_from_volume)
    assert back.sigma_t == asked.sigma_t
    capsys.readouterr()
    assert run(["info", str(path), "--up", "z", "--scale", "0.5"]) == 0
    told = capsys.readouterr()
    assert "bounds m: ((0, 0, -1.5), (1, 2, 0))" in told.out
    # What rendering would say, info says too.
    assert "says nothing about light" in told.err


@pytest.mark.needs("xarray")
def test_a_grid_whose_axes_say_which_is_up_is_not_turned(tmp_path):
    import xarray

    path = tmp_path / "a.nc"
    xarray.Dataset({"density": (("z", "y", "x"), plume())}).to_netcdf(path)
    scene, turned = load(path), load(path, up="z")
    np.testing.assert_allclose(scene.bounds, turned.bounds)
    assert "a.nc: up is left out" in " ".join(turned.warnings)
    (tmp_path / "a.toml").write_text('[[volume]]\nfile = "a.nc"\nsigma_t = 1\nup = "z"\n')
    assert "a.nc: up is left out" in " ".join(load(tmp_path / "a.toml").warnings)


def test_a_sequence_has_a_frame_for_each_of_its_grids(tmp_path, monkeypatch, capsys):
    for k in range(4):
        np.save(tmp_path / f"smoke_{k}.npy", plume())
    monkeypatch.setattr("airlight.scene.io.volume_scene.DEFAULT_FPS", 12.0)
    assert run(["info", str(tmp_path)]) == 0
    assert "fps 12, loop False, frames 4," in capsys.readouterr().out
