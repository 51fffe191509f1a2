"""`airlight figure`: what it writes and says, and how it refuses."""

from __future__ import annotations

import json

import PIL.Image
import pytest

from airlight.app import cli
from airlight.errors import SettingsError
from airlight.figures.registry import FIGURES


def test_flatland_from_the_command_line(tmp_path, capsys):
    folder = tmp_path / "new" / "figures"
    assert cli.run(["figure", "clpv-5", "-o", str(folder), "--size", "120x120", "-q"]) == 0
    assert capsys.readouterr().out == f"{folder / 'clpv-5.png'}\n"
    assert PIL.Image.open(folder / "clpv-5.png").width > 6 * 240
    told = json.loads((folder / "clpv-5.json").read_text("utf-8"))
    assert told["command"] == f"airlight figure clpv-5 -o {folder} --size 120x120"
    errors = told["numbers"]["relative_l2"]["two lights, 2 bands"]
    assert errors["centroid"] < errors["dom8"] < errors["dom4"] < errors["paper"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["clpv-55", "-o", "x"], "error: there is no figure 'clpv-55'. Did you mean 'clpv-5'?\n"),
        (["clpv-5"], "error: there is no folder to draw into. Name one: -o DIR\n"),
        (["-o", "x"], "error: no figure is named. Name some of clpv-1, clpv-5, "),
    ],
)
def test_what_cannot_be_drawn_is_said_at_once(capsys, words, message):
    assert cli.run(["figure", *words]) == 2
    assert capsys.readouterr().err.startswith(message)


def test_one_that_fails_does_not_cost_the_others(monkeypatch, tmp_path, capsys):
    def refuse(request):
        raise SettingsError("not today")

    monkeypatch.setattr("airlight.figures.clpv_7.draw", refuse)
    assert cli.run(["figure", "clpv-7", "clpv-5", "-o", str(tmp_path), "-q"]) == 2
    said = capsys.readouterr()
    assert said.out == f"{tmp_path / 'clpv-5.png'}\n"
    assert said.err == "error: 1 of 2 figures could not be drawn: clpv-7: not today\n"


def test_a_mistake_of_ours_does_not_either_and_ends_with_one(monkeypatch, tmp_path, capsys):
    def stumble(request):
        raise ZeroDivisionError("division\nby zero")

    monkeypatch.setattr("airlight.figures.clpv_7.draw", stumble)
    assert cli.run(["figure", "clpv-7", "clpv-5", "-o", str(tmp_path), "-q"]) == 1
    said = capsys.readouterr()
    assert said.out == f"{tmp_path / 'clpv-5.png'}\n"
    assert said.err == (
        "error: 1 of 2 figures could not be drawn: clpv-7: internal error: ZeroDivisionError: "
        "division by zero. Please report it, with AIRLIGHT_DEBUG=1.\n"
    )
    assert cli.run(["figure", "clpv-7", "-o", str(tmp_path), "-q"]) == 1  # alone: as any other
    assert capsys.readouterr().err.startswith("internal error: ZeroDivisionError: division by zero")


def test_the_list_names_them_all(capsys):
    assert cli.run(["figure", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(FIGURES)
    assert all(known.shows in line for known, line in zip(FIGURES.values(), lines, strict=True))
