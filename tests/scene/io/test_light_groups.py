"""[[light]] type = "points": arrays from a file."""

from __future__ import annotations

import numpy as np
import pytest

from airlight import load
from airlight.errors import SceneError
from airlight.scene.io.toml_text import scene_text

SCENE = """
[[mesh]]
shape = "quad"
[[light]]
type = "points"
file = "sparks.npz"
"""


@pytest.fixture
def scene_file(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    positions = np.random.default_rng(1).random((500, 3))
    np.savez(tmp_path / "sparks.npz", positions=positions, intensities=[[0.1, 0.2, 0.3]])
    return tmp_path / "scene.toml"


def test_the_file_becomes_a_group_and_no_daylight_is_added(scene_file):
    scene = load(scene_file)
    assert [len(group) for group in scene.light_groups] == [500]
    assert scene.lights == ()
    assert scene.environment is None


def test_a_saved_scene_names_the_file_again(scene_file, tmp_path):
    scene = load(scene_file)
    (tmp_path / "below").mkdir()
    text = scene_text(scene, scene, str(scene_file), tmp_path / "below")
    (tmp_path / "below" / "again.toml").write_text(text)
    again = load(tmp_path / "below" / "again.toml")
    np.testing.assert_array_equal(again.light_groups[0].positions, scene.light_groups[0].positions)


def _text(path):
    path.write_text("positions")


def _one_array(path):
    with path.open("wb") as file:
        np.save(file, np.zeros((3, 3)))


def _pickled(path):
    np.savez(path, positions=np.array([object()]), intensities=np.ones((1, 3)))


def _misnamed(path):
    np.savez(path, position=np.zeros((1, 3)), intensities=np.ones((1, 3)))


def _flat(path):
    np.savez(path, positions=np.zeros((2, 2)), intensities=np.ones((2, 3)))


NOT_NPZ = "sparks.npz: is not a readable .npz: File is not a zip file. Write it with numpy.savez."


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda path: path.unlink(), "[[light]] 1: file 'sparks.npz' does not exist"),
        (_text, NOT_NPZ),
        (_pickled, "sparks.npz: holds Python objects, it must hold numbers"),
        (_one_array, NOT_NPZ),
        (_misnamed, "sparks.npz: has no array 'positions'. Did you mean 'position'?"),
        (_flat, "sparks.npz: positions must be an (N, 3) array, not (2, 2)"),
    ],
)
def test_bad_files_get_one_clear_message(scene_file, spoil, message):
    spoil(scene_file.parent / "sparks.npz")
    with pytest.raises(SceneError) as error:
        load(scene_file)
    assert message in str(error.value)
