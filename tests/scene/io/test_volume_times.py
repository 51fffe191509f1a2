"""How many grids a second a bare sequence shows: told, and asked for."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.scene.io import load


def smoke(tmp_path, count=4):
    for k in range(count):
        np.save(tmp_path / f"smoke.{k + 1:04d}.npy", np.full((2, 2, 2), k + 1.0, np.float32))
    return tmp_path


def densest(scene, time_s):
    return float(scene.at(time_s).volumes[0].density.max())


def test_how_many_follow_each_other_in_a_second_is_told_and_asked_for(tmp_path, capsys):
    scene = load(smoke(tmp_path))
    assert f"{tmp_path}: 4 grids follow each other 24 a second (--sequence-fps N" in " ".join(
        scene.warnings
    )
    assert [densest(scene, k / 24) for k in range(4)] == [1, 2, 3, 4]
    slow = load(tmp_path, sequence_fps=2)
    assert [densest(slow, k / 2) for k in range(4)] == [1, 2, 3, 4]
    assert (slow.animation.last_s, slow.animation.fps) == (2.0, 2.0)
    assert run(["info", str(tmp_path), "--sequence-fps", "2"]) == 0
    told = capsys.readouterr()
    assert "end_s 2, fps 2," in told.out and "follow each other 2 a second" in told.err


def test_one_grid_has_no_rate(tmp_path):
    path = smoke(tmp_path, 1) / "smoke.0001.npy"
    said = "smoke.0001.npy: sequence_fps is left out, as one grid is shown and none follows it"
    assert said in load(path, sequence_fps=2).warnings
    assert said not in load(path).warnings
    for wrong in (0.0, -1.0, float("nan")):
        with pytest.raises(SceneError, match="sequence_fps"):
            load(path, sequence_fps=wrong)


@pytest.mark.needs("xarray", "scipy")
def test_times_of_a_file_follow_each_other_as_asked(tmp_path):
    import xarray

    values = np.arange(1.0, 5.0)[:, None, None, None] * np.ones((4, 2, 2, 2))
    dims = ("time", "z", "y", "x")

    def written(name, times, attributes):
        data = xarray.Dataset({"density": (dims, values)}, {"time": ("time", times, attributes)})
        data.to_netcdf(tmp_path / name)
        return tmp_path / name

    even = written("even.nc", 60.0 * np.arange(4), {"units": "seconds since 2000-01-01"})
    scene = load(even, sequence_fps=0.5)
    assert [densest(scene, 2.0 * k) for k in range(4)] == [1, 2, 3, 4]
    assert "its times follow each other 0.5 a second" in " ".join(scene.warnings)
    assert "a sequence shows its times evenly" not in " ".join(scene.warnings)
    # Hours that are not alike are told, since the sequence does not follow them.
    uneven = load(written("uneven.nc", [0.0, 1.0, 2.0, 30.0], {"units": "h"}))
    said = "uneven.nc: 'time' is not evenly spaced: a sequence shows its times evenly"
    assert said in uneven.warnings
    assert "sequence_fps is left out" in " ".join(
        load(even, grid="density[2]", sequence_fps=3).warnings
    )


def test_a_scene_file_that_is_written_shows_as_many_a_second(tmp_path):
    smoke(tmp_path)
    for number, (name, fps) in enumerate((("smoke.*.npy", 2.0), ("smoke.0001.npy", None))):
        out = tmp_path / f"out{number}.toml"
        assert run(["convert", str(tmp_path / name), str(out), "--sequence-fps", "2"]) == 0
        moving = load(out).animation
        assert (moving and moving.fps) == fps
