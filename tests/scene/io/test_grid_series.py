"""A folder, or a pattern, of density grids is a sequence; what is none is one message."""

from __future__ import annotations

import json

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.app.view.watch import Watch, named_files
from airlight.errors import SceneError
from airlight.scene.io import load
from airlight.scene.io.dense_part import dense_box
from airlight.scene.io.grid_series import is_series, kind_of, series_of
from airlight.scene.io.ledger import noted

SIDE = 6
FPS = 24.0
GROWS = (1, 2, 6, 5)
"""Layers of the puff in each file; the fullest of them is not the last."""


def puff(layers: int) -> np.ndarray:
    values = np.zeros((SIDE, SIDE, SIDE), np.float32)
    values[:, :layers, :] = 2.0
    return values


@pytest.fixture
def smoke(tmp_path):
    folder = tmp_path / "smoke"
    folder.mkdir()
    for number, layers in zip((1, 2, 9, 10), GROWS, strict=True):
        box = [(0, 0, 0), (1, 1, 1)]
        np.savez(folder / f"puff_{number}.npz", density=puff(layers), bounds=box)
    # Notes and images beside the grids are nobody's scene.
    (folder / "settings.json").write_text("{}")
    (folder / ".puff_11.npz").write_bytes(b"half of it")
    return folder


def layers_at(scene, time_s: float) -> float:
    return float((scene.at(time_s).volumes[0].density > 0).any(axis=(0, 2)).sum())


@pytest.mark.parametrize("pattern", ["", "*.npz", "puff_*", "puff_?*.npz"])
def test_grids_follow_each_other_by_their_numbers(smoke, pattern):
    scene = load(smoke / pattern)
    assert [layers_at(scene, k / FPS) for k in range(4)] == [*GROWS]
    assert scene.animation.last_s == pytest.approx(4 / FPS)
    assert scene.name == ("puff" if pattern.startswith("puff") else "grids" if pattern else "smoke")


def test_at_rest_the_fullest_is_shown_and_all_of_them_are_framed(smoke):
    scene, alone = load(smoke), load(smoke / "puff_9.npz")
    (volume,) = scene.volumes
    np.testing.assert_array_equal(volume.density, puff(6))
    # What is chosen for the grid is chosen for that one.
    assert volume.sigma_t == alone.volumes[0].sigma_t
    np.testing.assert_allclose(dense_box(scene), dense_box(alone), atol=1e-6)
    told = scene.warnings[-1]
    assert "4 grids follow each other 24 a second" in told
    assert "puff_9.npz is shown, the fullest of a few" in told


def test_a_growing_plume_is_framed_as_large_as_it_gets(tmp_path):
    for k, side in enumerate((1.0, 4.0, 2.0)):
        box = [(0, 0, 0), (side, side, side)]
        # The largest holds less than the small one, thin as it is.
        np.savez(tmp_path / f"{k}.npz", density=np.full((3, 3, 3), 1 / side**4), bounds=box)
    scene = load(tmp_path)
    assert scene.volumes[0].bounds[1] == (1.0, 1.0, 1.0)
    assert dense_box(scene)[1].max() == pytest.approx(4.0)


def test_grids_without_a_place_are_of_one_box(tmp_path):
    for k in range(3):
        np.save(tmp_path / f"a{k}.npy", np.full((2, 3, 4), k, np.float32))
    scene = load(tmp_path / "a*.npy", scale=3.0)
    assert scene.volumes[0].density.max() == 2
    for k in range(3):
        volume = scene.at(k / FPS).volumes[0]
        assert volume.density.max() == k and volume.bounds == scene.volumes[0].bounds
        np.testing.assert_array_equal(volume.world_from_volume, scene.volumes[0].world_from_volume)


def test_flames_and_colours_move_too(tmp_path):
    for k in range(2):
        grids = {"density": puff(3), "flame": puff(k + 1), "Cd": np.full((SIDE,) * 3 + (3,), 0.5)}
        np.savez(tmp_path / f"fire{k}.npz", **grids)
    scene = load(tmp_path)
    for k in range(2):
        volume = scene.at(k / FPS).volumes[0]
        assert float(volume.emission.grid.sum()) == pytest.approx(puff(k + 1).sum())
        assert volume.albedo_grid is not None


def test_one_grid_alone_is_that_grid(smoke, tmp_path):
    for file in sorted(smoke.glob("puff_*"))[1:]:
        file.unlink()
    scene = load(smoke)
    assert scene.animation is None and scene.name == "puff_1"
    assert run(["convert", str(smoke), str(tmp_path / "a.toml")]) == 0
    assert 'file = "smoke/puff_1.npz"' in (tmp_path / "a.toml").read_text()


def test_what_is_no_sequence_is_one_message(smoke, tmp_path):
    def refused(path) -> str:
        with pytest.raises(SceneError) as caught:
            load(path)
        assert str(path) in str(caught.value)
        return str(caught.value)

    np.save(smoke / "puff_1.npy", puff(1))
    np.save(smoke / "other.npy", puff(1))
    text = refused(smoke)
    assert "no sequence: puff_*.npz (4), other.npy (1), puff_*.npy (1)" in text
    assert f"'{smoke}/puff_*.npz'" in text
    assert load(smoke / "puff_*.npz").animation is not None
    (smoke / "room.toml").write_text("")
    assert f"and other scenes (as room.toml). Name one of them: '{smoke}/*.npy'" in refused(smoke)
    # Folders without grids, and where those may be.
    assert f"Name the folder that holds them: {smoke}" in refused(tmp_path)
    (tmp_path / "empty").mkdir()
    assert "names no density grids. Grids end in .npy" in refused(tmp_path / "empty")
    (tmp_path / "empty" / "a.obj").write_text("")
    assert f"A scene is one file: {tmp_path}/empty/a.obj" in refused(tmp_path / "empty")
    assert "names no density grids" in refused(smoke / "fog_*.vdb")
    assert "not in that of a folder" in refused(tmp_path / "sm*" / "puff_*.npz")


def test_a_file_or_a_store_is_no_series_whatever_it_is_called(tmp_path):
    path = tmp_path / "run[3].npy"
    np.save(path, puff(1))
    (tmp_path / "store.zarr").mkdir()
    for file in (path, tmp_path / "store.zarr", tmp_path / "room.toml"):
        assert not is_series(file) and series_of(file) == () and kind_of(file) == file.suffix
    assert load(path).animation is None


def test_options_are_those_of_the_grids(smoke):
    assert load(smoke, grid="density", up="z").animation is not None
    with pytest.raises(SceneError, match="variant is for mesh files"):
        load(smoke, variant="red")


def test_commands_take_a_folder_or_a_pattern(smoke, tmp_path, capsys):
    assert run(["info", f"{smoke}/puff_*.npz", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["files"], facts["shown"], facts["grids"][0]) == (4, "puff_9.npz", "density")
    assert facts["animation"]["frames"] == 4
    assert run(["validate", f"{smoke}/"]) == 0
    # As a scene file it is the same sequence.
    out = tmp_path / "out.toml"
    assert run(["convert", str(smoke), str(out)]) == 0
    back = load(out)
    assert [layers_at(back, k / FPS) for k in range(4)] == [*GROWS]
    # A grid that cannot be shown is told before anything is rendered.
    (smoke / "puff_2.npz").write_bytes(b"no")
    assert run(["validate", str(smoke)]) == 2
    assert "puff_2.npz" in capsys.readouterr().err


def test_no_output_replaces_a_grid_of_the_folder(smoke, tmp_path, capsys):
    assert run(["convert", str(smoke), str(smoke / "puff_2.npz")]) == 2
    target = tmp_path / "a.xml"
    target.symlink_to(smoke / "puff_2.npz")
    assert run(["convert", f"{smoke}/*.npz", str(target)]) == 2
    assert "the command reads this file" in capsys.readouterr().err
    # Beside them there is room for one.
    assert run(["convert", str(smoke), str(smoke / "a.xml")]) == 0


def test_a_pattern_that_a_shell_has_spread_is_told_to_be_quoted(smoke, capsys):
    files = sorted(map(str, smoke.glob("*.npz")))
    assert run(["render", *files, "-o", "a.png"]) == 2
    assert "A pattern of files stands in quotes" in capsys.readouterr().err


def test_grids_that_come_and_change_are_edits(smoke):
    now = iter(range(1000))
    for path in (smoke, smoke / "puff_*.npz"):
        with noted() as files:
            load(path)
        assert {f.name for f in files.read} == {f.name for f in named_files(path)}
        watch = Watch(path, lambda: float(next(now)), files.stamps)

        def edits(watch=watch) -> int:
            return sum(watch.changed() for _ in range(4))

        assert edits() == 0
        # An image into the folder is none.
        (smoke / "frame.png").write_bytes(b"png")
        assert edits() == 0
        np.savez(smoke / "puff_11.npz", density=puff(2))
        assert edits() == 1
        (smoke / "puff_11.npz").unlink()
        assert edits() == 1
