"""Grids beside a density, at its time: in one file, in sequences, and in bare files."""

from __future__ import annotations

import json

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.scene.io import load, netcdf
from airlight.scene.io.grid_times import time_axes_of
from airlight.scene.io.toml_text import scene_text
from airlight.scene.io.volume_scene import FPS

pytestmark = pytest.mark.needs("xarray", "scipy")
RAMP = np.linspace(0.1, 1.0, 24, dtype=np.float32).reshape(2, 3, 4)  # height, y, x


def written(path, **grids):
    """A NetCDF file: a grid of four dimensions has times."""
    import xarray

    times = {name: [f"time{len(v)}"] if v.ndim == 4 else [] for name, v in grids.items()}
    data = {name: ([*times[name], "z", "y", "x"], v) for name, v in grids.items()}
    cells = {
        name: (name, np.arange(float(n)), {"units": "m"})
        for name, n in zip("zyx", RAMP.shape, strict=True)
    }
    xarray.Dataset(data, coords=cells).to_netcdf(path, engine="scipy")
    return path


def by_time(*factors):
    return np.stack([RAMP * np.float32(f) for f in factors])


def scene_of(folder, text, name="a.toml"):
    (folder / name).write_text(f"[[volume]]\nsigma_t = 1\n{text}\n")
    return load(folder / name)


def peaks(volume):
    """The greatest density, emission or temperature, and albedo."""
    glow = volume.emission
    values = glow.grid if glow.temperature is None else glow.temperature
    colours = volume.albedo_grid
    tinted = 1.0 if colours is None else float(colours.max())
    return float(volume.density.max()), float(values.max()), tinted


def test_a_grid_beside_a_density_is_of_the_densitys_time(tmp_path):
    # The first time with any density is number 1, that with any heat number 0.
    written(tmp_path / "a.nc", smoke=by_time(0, 1, 2), hot=by_time(10, 20, 30))
    for grid, expected in (("smoke", (1, 20)), ("smoke[2]", (2, 30)), ("smoke[-3]", (0, 10))):
        scene = scene_of(tmp_path, f'file = "a.nc"\ngrid = "{grid}"\nemission_grid = "hot"')
        assert peaks(scene.volumes[0])[:2] == pytest.approx(expected)
    # A number of its own wins.
    own = scene_of(tmp_path, 'file = "a.nc"\ngrid = "smoke[2]"\nemission_grid = "hot[0]"')
    assert peaks(own.volumes[0])[:2] == pytest.approx((2, 10))


def test_colours_are_of_the_densitys_time(tmp_path):
    written(tmp_path / "a.nc", smoke=by_time(0, 1), tint=by_time(0.2, 0.4), g=by_time(0.5, 0.7))
    keys = 'file = "a.nc"\ngrid = "smoke"\nalbedo_grid = "tint"\ng_grid = "g"'
    volume = scene_of(tmp_path, keys).volumes[0]
    assert volume.albedo_grid.max() == pytest.approx(0.4)
    assert volume.g_grid.max() == pytest.approx(0.7)


@pytest.mark.parametrize(
    ("smoke", "hot", "expected"),
    [
        (by_time(1, 2), RAMP * 10, [(1, 10), (2, 10)]),  # heat without an axis of times
        (by_time(1, 2), by_time(10), [(1, 10), (2, 10)]),  # of one time
        (RAMP, by_time(10, 20), [(1, 10), (1, 20)]),  # density without one
        (by_time(1, 2), by_time(0, 20), [(1, 0), (2, 20)]),
    ],
)
def test_static_grids_are_the_same_in_all_frames(tmp_path, smoke, hot, expected):
    written(tmp_path / "a.nc", smoke=smoke, hot=hot)
    keys = 'sequence = "a.nc"\nsequence_fps = 1\ngrid = "smoke"\nemission_grid = "hot"'
    scene = scene_of(tmp_path, keys)
    for k, (density, heat) in enumerate(expected):
        assert peaks(scene.at(float(k)).volumes[0])[:2] == pytest.approx((density, heat))


def test_a_numbered_grid_is_the_same_in_all_frames(tmp_path):
    written(tmp_path / "a.nc", smoke=by_time(1, 2, 3), hot=by_time(10, 20))
    keys = 'sequence = "a.nc"\nsequence_fps = 1\ngrid = "smoke"\nemission_grid = "hot[-1]"'
    scene = scene_of(tmp_path, keys)
    for k in range(3):
        assert peaks(scene.at(float(k)).volumes[0])[:2] == pytest.approx((k + 1, 20))


def test_grids_of_other_numbers_of_times_are_refused_by_name(tmp_path):
    written(tmp_path / "a.nc", smoke=by_time(1, 2, 3), hot=by_time(10, 20))
    keys = 'sequence = "a.nc"\ngrid = "smoke"\nemission_grid = "hot"'
    with pytest.raises(SceneError, match=r"a\.nc.*3 times of 'smoke', but 2 of 'hot'"):
        scene_of(tmp_path, keys)
    with pytest.raises(SceneError, match=r"a\.nc.*2 times of 'hot', but number 2 is shown"):
        scene_of(tmp_path, 'file = "a.nc"\ngrid = "smoke[2]"\nemission_grid = "hot"')


def test_what_is_wrong_with_a_grid_beside_a_density_is_told(tmp_path):
    hot = by_time(10, 20)
    hot[0, 0, 0, 0] = np.nan
    written(tmp_path / "a.nc", smoke=by_time(1, 2), hot=hot)
    scene = scene_of(tmp_path, 'file = "a.nc"\ngrid = "smoke"\nemission_grid = "hot"')
    assert any("'hot' has 1 missing values" in text for text in scene.warnings)


def test_files_are_opened_once_to_count_their_times(tmp_path, monkeypatch):
    for k in range(5):
        written(tmp_path / f"run.{k}.nc", smoke=by_time(1, 2))
    opened, own = [], netcdf.opened_dataset
    monkeypatch.setattr(netcdf, "opened_dataset", lambda path: opened.append(path) or own(path))
    scene = scene_of(tmp_path, 'sequence = "run.*.nc"\ngrid = "smoke"')
    # Once each to count, then the first to be read.
    assert [path.name for path in opened[:6]] == [f"run.{k}.nc" for k in (*range(5), 0)]
    assert len(scene.animation.tracks[0].density.files) == 10


def test_a_bare_file_with_flames_and_colours_moves_and_is_written(tmp_path):
    grids = {"temperature": by_time(0, 1500, 1000), "albedo": by_time(1, 0.5, 0.9)}
    path = written(tmp_path / "fire[3].nc", smoke=by_time(0, 1, 2), **grids)
    scene = load(path)
    expected = [(1, 1500, 0.5), (2, 1000, 0.9)]
    text = scene_text(scene, scene, str(path), tmp_path)
    (tmp_path / "a.toml").write_text(text)
    for shown in (scene, load(tmp_path / "a.toml")):
        for k, values in enumerate(expected):
            volume = shown.at(k / FPS).volumes[0]
            assert peaks(volume) == pytest.approx(values)
            assert volume.emission.radiance == scene.volumes[0].emission.radiance


def test_a_number_asks_for_one_time_of_a_bare_fire(tmp_path):
    hot = by_time(500, 1500, 1000)
    path = written(tmp_path / "a.nc", smoke=by_time(1, 2, 3), temperature=hot)
    scene = load(path, grid="smoke[2]")
    assert scene.animation is None and peaks(scene.volumes[0])[:2] == pytest.approx((3, 1000))


def test_info_names_the_grids_of_a_file_and_their_times(tmp_path, capsys):
    path = written(tmp_path / "a.nc", smoke=by_time(1, 2, 3), hot=by_time(1, 2), tint=RAMP)
    assert run(["info", str(path), "--grid", "smoke", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert sorted(facts["grids"]) == ["hot", "smoke", "tint"]
    assert facts["times"] == {"smoke": 3, "hot": 2}
    axes = [(axis["name"], axis["grids"]) for axis in facts["time_axes"]]
    assert axes == [("time3", ["smoke"]), ("time2", ["hot"])]
    assert facts["animation"]["frames"] == 3
    np.savez(tmp_path / "a.npz", smoke=RAMP)
    assert run(["info", str(tmp_path / "a.npz"), "--grid", "smoke", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["grids"] == ["smoke"] and "times" not in facts and facts["animation"] is None


@pytest.mark.parametrize(
    "name", ["run[3].nc", "run[[]*].nc", "run[13].nc", "run?3?.nc", "run[*].nc"]
)
def test_names_with_brackets_are_found(tmp_path, name):
    written(tmp_path / "run[3].nc", smoke=by_time(1, 2))
    if name == "run[13].nc":  # one character of several, where no file has that name
        (tmp_path / "run[3].nc").rename(tmp_path / "run3.nc")
    scene = scene_of(tmp_path, f'sequence = "{name}"\ngrid = "smoke"')
    assert scene.animation is not None


def test_axes_of_times_have_units_and_values(tmp_path):
    import xarray

    said = {"units": "seconds since 2020-01-01"}
    data = {"smoke": (["time", "z", "y", "x"], by_time(1, 2))}
    times = {"time": ("time", [0.5, 2.0], said)}
    xarray.Dataset(data, coords=times).to_netcdf(tmp_path / "a.nc", engine="scipy")
    (axis,) = time_axes_of((tmp_path / "a.nc",))
    assert axis == {"name": "time", **said, "values": [0.5, 2.0], "grids": ["smoke"]}
