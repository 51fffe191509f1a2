"""Files are read and written whole, or the reason is said."""

from __future__ import annotations

import os

import pytest

from airlight.errors import OutputError, SceneError
from airlight.scene.io.files import read_bytes, whole_file


def test_reading(tmp_path):
    (tmp_path / "a").write_bytes(b"x")
    assert read_bytes(tmp_path / "a") == b"x"
    with pytest.raises(SceneError, match=r"b: file not found\. Check the path\."):
        read_bytes(tmp_path / "b")
    with pytest.raises(SceneError, match="this is a folder, not a file"):
        read_bytes(tmp_path)
    with pytest.raises(SceneError, match="cannot be read"):
        read_bytes(tmp_path / ("x" * 5000))


def test_a_file_appears_whole(tmp_path):
    path = tmp_path / "a.png"
    with whole_file(path) as part:
        part.write_bytes(b"new")
        assert not path.exists()
        assert part.suffix == ".png"
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(b"old")
    full = pytest.raises(OutputError, match=r"cannot be written \(No space left on device\)")
    with full, whole_file(path) as part:
        part.write_bytes(b"ne")
        raise OSError(28, "No space left on device")
    with pytest.raises(KeyError), whole_file(path):
        raise KeyError
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_places_that_cannot_be_written(tmp_path):
    absent = pytest.raises(OutputError, match=r"does not exist\. Create it first\.")
    with absent, whole_file(tmp_path / "no" / "a.png"):
        pass
    with pytest.raises(OutputError, match="this is a folder"), whole_file(tmp_path):
        pass


@pytest.mark.skipif(os.geteuid() == 0 if hasattr(os, "geteuid") else True, reason="root may write")
def test_a_folder_without_permission(tmp_path):
    tmp_path.chmod(0o500)
    try:
        refused = pytest.raises(OutputError, match="Choose another folder")
        with refused, whole_file(tmp_path / "a.png"):
            pass
    finally:
        tmp_path.chmod(0o700)
