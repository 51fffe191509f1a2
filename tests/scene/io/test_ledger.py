"""Inputs are known by what they are, whatever they are called; outputs by their places."""

from __future__ import annotations

import os

import pytest

from airlight.errors import OutputError
from airlight.scene.io.files import read_bytes
from airlight.scene.io.ledger import (
    check_distinct,
    check_output,
    note_read,
    note_written,
    own_files,
    recorded,
)
from airlight.scene.io.writing import whole_file

posix = pytest.mark.skipif(os.name != "posix", reason="links")


def test_outside_a_command_nothing_is_kept(tmp_path):
    note_read(tmp_path / "a")
    note_written(tmp_path / "a")
    check_output(tmp_path / "a")


@posix
def test_a_file_is_itself_under_every_name(tmp_path, monkeypatch):
    source = tmp_path / "a.toml"
    source.write_text("x")
    (tmp_path / "soft.toml").symlink_to(source)
    (tmp_path / "hard.toml").hardlink_to(source)
    (tmp_path / "other.toml").write_text("x")
    (tmp_path / "sub").mkdir()
    monkeypatch.chdir(tmp_path / "sub")
    with recorded() as ledger:
        note_read("../a.toml")
        assert [path.name for path in ledger.read] == ["a.toml"]
        monkeypatch.chdir(tmp_path)  # a relative path was meant from where the command was then
        for name in ("a.toml", "soft.toml", "hard.toml", "sub/../a.toml"):
            with pytest.raises(OutputError, match="Choose another name for the output"):
                check_output(tmp_path / name)
        check_output(tmp_path / "other.toml")
        check_output(tmp_path / "new.toml")


def test_a_link_that_was_read_keeps_its_file(tmp_path):
    source, link = tmp_path / "a.toml", tmp_path / "link.toml"
    source.write_text("x")
    link.symlink_to(source)
    with recorded():
        note_read(link)
        with pytest.raises(OutputError, match="the command reads this file"):
            check_output(source)


def test_what_airlight_keeps_for_itself_is_no_input(tmp_path):
    path = tmp_path / "sequence.json"
    path.write_text("{}")
    with recorded() as ledger:
        with own_files():
            read_bytes(path)
        check_output(path)
        read_bytes(path)
        assert ledger.read == (path,)


def test_two_outputs_are_two_files(tmp_path):
    (tmp_path / "link.json").symlink_to(tmp_path / "a.json")
    pair = (tmp_path / "a.json", tmp_path / "link.json")
    with pytest.raises(OutputError, match=r"link\.json: two outputs .*: this and '.*a\.json'"):
        check_distinct(pair)
    with recorded():
        with whole_file(pair[0]) as part:
            part.write_text("1")
        with whole_file(pair[0]) as part:  # the same output again, as a sequence's own notes
            part.write_text("2")
        with pytest.raises(OutputError, match="one file"), whole_file(pair[1]):
            pass
    check_distinct((tmp_path / "a.json", tmp_path / "b.json"))
    (tmp_path / "b.json").hardlink_to(tmp_path / "a.json")
    with pytest.raises(OutputError, match="one file"):
        check_distinct((tmp_path / "a.json", tmp_path / "b.json"))
