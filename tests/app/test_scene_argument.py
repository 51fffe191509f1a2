"""SCENE: a file or builtin:NAME, with its warnings on stderr."""

from __future__ import annotations

import pytest

from airlight.app.scene_argument import load_scene, show_warnings
from airlight.errors import SceneError
from airlight.scene import Scene


def test_a_builtin_scene():
    assert load_scene("builtin:cornell").triangle_count > 0


def test_an_unknown_builtin_names_the_nearest():
    with pytest.raises(SceneError, match=r"'cornel'\. Did you mean 'cornell'\?"):
        load_scene("builtin:cornel")


def test_a_file(tmp_path):
    (tmp_path / "a.toml").write_text('[[mesh]]\nshape = "box"\nemission = 1\n')
    assert load_scene(str(tmp_path / "a.toml")).triangle_count == 12


def test_warnings_go_to_stderr(capsys):
    show_warnings(Scene(warnings=("one", "two")))
    assert capsys.readouterr() == ("", "warning: one\nwarning: two\n")


def test_of_very_many_warnings_the_first_are_told(capsys):
    show_warnings(Scene(warnings=(*("one",) * 5, *(f"{k}" for k in range(100)))))
    lines = capsys.readouterr().err.splitlines()
    assert lines[:2] == ["warning: one", "warning: 0"]
    assert len(lines) == 61 and lines[-1] == "warning: and 41 more like these"
