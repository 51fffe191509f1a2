"""`render --watch`: again after each save, and through a broken one."""

from __future__ import annotations

import os

import pytest

from airlight.app import render
from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.scene.io.ledger import note_read


class Stop(Exception):
    """Ends the watch."""


def test_each_save_is_one_more_piece_of_work(tmp_path, monkeypatch, capsys):
    file, done = tmp_path / "a.toml", []
    file.write_text("one")
    texture = tmp_path / "wood.png"
    texture.write_text("1")
    clock = [0.0]

    def later(seconds: float) -> None:
        """Half a second passes; at some of them somebody saves."""
        clock[0] += 0.5
        if clock[0] == 7.0:
            os.utime(texture, ns=(10**18, 10**18))
        if clock[0] in (2.0, 5.0):
            file.write_text(f"saved at {clock[0]}")
            os.utime(file, ns=(int(clock[0] * 1e9), int(clock[0] * 1e9)))

    def work() -> None:
        note_read(texture)
        done.append(file.read_text())
        if len(done) == 2:
            raise SceneError("is broken", where=file)
        if len(done) == 4:
            raise Stop

    monkeypatch.setattr(render.time, "sleep", later)
    monkeypatch.setattr(render, "Watch", lambda path: _watch(path, lambda: clock[0]), raising=True)
    with pytest.raises(Stop):
        render.watched(str(file), work)
    assert done == ["one", "saved at 2.0", "saved at 5.0", "saved at 5.0"]
    said = capsys.readouterr().err
    assert "error: " in said and "is broken" in said
    assert said.count("watching") == 3


def _watch(path, clock):
    from airlight.app.view.watch import Watch

    return Watch(path, clock)


def test_builtin_scenes_are_not_watched(tmp_path, capsys):
    out = str(tmp_path / "a.png")
    assert run(["render", "builtin:cornell", "-o", out, "--watch"]) == 2
    assert "--watch is for scene files" in capsys.readouterr().err
