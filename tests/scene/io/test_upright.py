"""Which way is up in a grid: its axes say it, somebody asks for it, or a sentence tells."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.scene.io import load
from airlight.scene.io.toml_meshes import upright_from_file
from airlight.scene.io.upright import upright_from_grid
from airlight.scene.io.volumes import read_volume

TOLD = "does not say which way is up: its y axis is taken as up and its z axis as depth"
SHAPE = (2, 3, 4)


def on_z() -> np.ndarray:
    """Dense at one end of z, the first axis."""
    values = np.zeros(SHAPE, np.float32)
    values[-1] = 1.0
    return values


def vti(path):
    text = " ".join(f"{v:g}" for v in on_z().ravel())
    path.write_text(
        '<VTKFile type="ImageData" version="1.0"><ImageData WholeExtent="0 4 0 3 0 2">'
        '<Piece Extent="0 4 0 3 0 2"><CellData><DataArray type="Float32" Name="density" '
        f'format="ascii">{text}</DataArray></CellData></Piece></ImageData></VTKFile>'
    )
    return path


def highest(scene) -> float:
    """Where in the world's height most of the density is, as a share of the box."""
    (volume,) = scene.volumes
    z, y, x = np.argwhere(volume.density > 0.0).mean(axis=0) + 0.5
    low, high = (np.array(corner) for corner in volume.bounds)
    place = low + np.array([x, y, z]) / volume.density.shape[::-1] * (high - low)
    world = volume.world_from_volume @ [*place, 1.0]
    bottom, top = (corner[1] for corner in scene.bounds)
    return float((world[1] - bottom) / (top - bottom))


def test_a_bare_grid_that_does_not_say_it_tells_how_it_is_turned(tmp_path):
    path = vti(tmp_path / "plume.vti")
    told = [text for text in load(path).warnings if TOLD in text]
    assert told == [f"plume.vti {TOLD} (--up z takes z as up)"]
    assert highest(load(path)) == pytest.approx(0.5)
    # What was asked for is not told, whichever it is; a scene file has the key.
    for up, share in (("y", 0.5), ("z", 0.75)):
        scene = load(path, up=up)
        assert TOLD not in " ".join(scene.warnings)
        assert highest(scene) == pytest.approx(share)
    (tmp_path / "a.toml").write_text('[[volume]]\nfile = "plume.vti"\nsigma_t = 1\n')
    assert TOLD not in " ".join(load(tmp_path / "a.toml").warnings)


def test_files_of_a_sequence_tell_it_once(tmp_path):
    for k in range(3):
        np.save(tmp_path / f"a{k}.npy", on_z())
    assert sum(TOLD in text for text in load(tmp_path).warnings) == 1
    assert highest(load(tmp_path, up="z").at(0.0)) == pytest.approx(0.75)


@pytest.mark.parametrize("command", ["info", "validate"])
def test_commands_tell_it(tmp_path, capsys, command):
    path = str(vti(tmp_path / "plume.vti"))
    assert run([command, path]) == 0
    assert f"warning: plume.vti {TOLD}" in capsys.readouterr().err
    assert run([command, path, "--up", "z"]) == 0
    assert TOLD not in capsys.readouterr().err


@pytest.mark.needs("xarray")
def test_axes_that_say_it_are_followed_and_those_that_do_not_are_told(tmp_path):
    import xarray

    # The height is known by its name, wherever it stands.
    named = xarray.Dataset(
        {"density": (("a", "b", "altitude"), np.moveaxis(on_z(), 0, -1))},
        coords={"altitude": ("altitude", [5.0, 15.0], {"units": "m"})},
    )
    named.to_netcdf(tmp_path / "named.nc")
    for up in (None, "y", "z"):
        scene = load(tmp_path / "named.nc", up=up)
        assert highest(scene) == pytest.approx(0.75)
        assert ("up is left out" in " ".join(scene.warnings)) == (up == "z")
    assert "say which way all of its axes go: a, b are y, x" in " ".join(scene.warnings)
    # Without a name the first one is the height, unless it is asked for the second.
    xarray.Dataset({"density": (("p", "q", "r"), on_z())}).to_netcdf(tmp_path / "bare.nc")
    scene = load(tmp_path / "bare.nc")
    assert "p, q, r are height, y, x (--up y takes q as up)" in " ".join(scene.warnings)
    assert [highest(load(tmp_path / "bare.nc", up=up)) for up in (None, "z", "y")] == pytest.approx(
        [0.75, 0.75, 0.5]
    )


def test_the_turn_of_a_grid_is_that_of_a_mesh(tmp_path):
    path = vti(tmp_path / "a.vti")
    grid = read_volume(path)
    turn, told = upright_from_grid({"up": "z"}, grid, path, is_bare=True)
    np.testing.assert_array_equal(turn, upright_from_file({"up": "z"}))
    assert told == ()
