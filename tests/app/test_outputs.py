"""Where results go: refused early, written whole."""

from __future__ import annotations

import json

import numpy as np
import pytest

from airlight.app import outputs
from airlight.app.outputs import check_writable, json_text, make_folder, write_json
from airlight.errors import OutputError


def test_a_good_place_is_left_as_it_was(tmp_path):
    check_writable(tmp_path / "a.PNG", (".png",))
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written(tmp_path, monkeypatch):
    from airlight.scene.io import writing

    def refuse(**_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(writing.tempfile, "TemporaryFile", refuse)
    with pytest.raises(OutputError, match=r"a\.png: cannot be written \(Permission denied\)"):
        check_writable(tmp_path / "a.png")


def test_numpy_values_become_plain_json(tmp_path):
    write_json({"a": np.float32(0.5), "b": np.arange(3)}, tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": 0.5, "b": [0, 1, 2]}


def test_a_failed_write_leaves_nothing(tmp_path):
    with pytest.raises(TypeError, match="object has no JSON form"):
        write_json({"a": object()}, tmp_path / "a.json")
    assert list(tmp_path.iterdir()) == []
    assert json_text({"é": 1}) == '{\n  "é": 1\n}'


def test_a_folder_in_which_no_file_can_be_made_is_refused_before_any_work(tmp_path, monkeypatch):
    make_folder(tmp_path / "a" / "b")
    assert list((tmp_path / "a" / "b").iterdir()) == []

    def refuse(**_):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(outputs.tempfile, "TemporaryFile", refuse)
    with pytest.raises(
        OutputError, match=r"/a: no file can be .* \(Read-only file system\)\. Choo"
    ):
        make_folder(tmp_path / "a")
