"""`airlight view` (airlight.app.view.cli) as it is asked for, before any window opens."""

from __future__ import annotations

from pathlib import Path

from airlight.app.cli import run

SCENE = Path(__file__).with_name("view_box.toml")


def test_it_is_listed_and_explains_itself(capsys):
    assert run(["view", "--help"]) == 0
    said = capsys.readouterr().out
    assert "airlight view room.toml --in browser" in said
    assert "the link is not encrypted" in " ".join(said.split())


def test_port_and_listen_are_for_browsers(capsys):
    for option in (["--port", "8900"], ["--listen", "0.0.0.0"]):
        assert run(["view", str(SCENE), *option]) == 2
        assert "belong to --in browser" in capsys.readouterr().err


def test_bad_input_is_one_message(tmp_path, capsys):
    for arguments, problem in (
        (["builtin:atrum"], "atrum"),
        ([str(tmp_path / "none.toml")], "none.toml"),
        ([str(SCENE), "-t", "lvp"], "unknown technique 'lvp'"),
        ([str(SCENE), "--size", "0x9"], "0x9"),
        ([str(SCENE), "--in", "space"], "'space'"),
    ):
        assert run(["view", *arguments]) == 2
        said = capsys.readouterr().err
        assert problem in said
        assert "Traceback" not in said
