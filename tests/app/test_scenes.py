"""`airlight scenes`: every built-in scene, with a line on what it shows."""

from __future__ import annotations

import json

from airlight.app import cli
from airlight.app.scenes import descriptions
from airlight.scene.builtin import BUILTIN


def test_every_scene_says_what_it_shows():
    known = descriptions()
    assert set(known) == {f"builtin:{name}" for name in BUILTIN}
    assert {"builtin:atrium", "builtin:cornell", "builtin:room"} <= set(known)
    assert all(known.values())


def test_one_line_each(capsys):
    assert cli.run(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(descriptions())


def test_as_json(capsys):
    assert cli.run(["scenes", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == descriptions()
