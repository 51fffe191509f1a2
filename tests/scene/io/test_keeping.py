"""A cache that cannot be used costs a warning, and what was kept in it stays."""

from __future__ import annotations

import errno

import pytest

from airlight.errors import OutputError
from airlight.scene.io.writing import keep

REMEDY = "Set AIRLIGHT_CACHE to a folder that can be written."


def written(part):
    part.write_bytes(b"costly")


def test_what_is_kept_is_there_whole(tmp_path):
    path = tmp_path / "new" / "cache" / "a.bin"
    assert keep(path, "it", written) == ""
    assert path.read_bytes() == b"costly"


def test_a_file_is_no_cache_folder(tmp_path):
    (tmp_path / "file").write_bytes(b"mine")
    path = tmp_path / "file" / "references" / "a.bin"
    assert keep(path, "the reference", written) == (
        f"the reference is not kept for the next time: {path}: Not a directory. {REMEDY}"
    )
    assert (tmp_path / "file").read_bytes() == b"mine"


def test_a_name_too_long_is_no_cache_folder(tmp_path):
    assert "File name too long" in keep(tmp_path / ("x" * 300) / "a", "it", written)


@pytest.mark.parametrize(
    "error", [OSError(errno.ENOSPC, "No space left on device"), OutputError("cannot be written")]
)
def test_a_full_disk_leaves_what_was_kept_before(tmp_path, error):
    path = tmp_path / "a.bin"
    assert keep(path, "it", written) == ""

    def full(part):
        part.write_bytes(b"half")
        raise error

    said = keep(path, "it", full)
    assert said.startswith(f"it is not kept for the next time: {path}: ") and said.endswith(REMEDY)
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [b"costly"]


def test_an_unwritable_folder_is_said(tmp_path, monkeypatch):
    def denied(*_, **__):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("pathlib.Path.mkdir", denied)
    assert "Permission denied" in keep(tmp_path / "cache" / "a.bin", "it", written)
