"""Shared options: sizes and settings from text."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner

from airlight.app.cli import run
from airlight.app.options import (
    SECONDS,
    Number,
    settings_option,
    shared_settings,
    size_option,
)
from airlight.errors import SettingsError
from airlight.scene import Scene


@click.command()
@size_option("8x4")
@settings_option()
def show(size: tuple[int, int], settings: dict[str, str]) -> None:
    click.echo(f"{size} {settings}")


def test_the_default_and_what_is_said():
    assert CliRunner().invoke(show, []).output == "None {}\n"
    assert "[default: 8x4]" in CliRunner().invoke(show, ["--help"]).output
    assert CliRunner().invoke(show, ["--size", "640X360"]).output == "(640, 360) {}\n"


def test_the_last_value_of_a_key_holds_and_values_may_hold_equals():
    arguments = ["-D", "a=1", "-D", "b-c = x=y", "-D", "a=2"]
    assert CliRunner().invoke(show, arguments).output == "None {'a': '2', 'b_c': 'x=y'}\n"


@pytest.mark.parametrize("text", ["12", "1x2x3", "ax4", "-1x4", "0x4", "4x16385", "٣x٤", ""])
def test_impossible_sizes_are_misuse(text):
    assert CliRunner().invoke(show, ["--size", text]).exit_code == 2


@pytest.mark.parametrize("text", ["nan", "inf", "-inf", "1e400", "-Infinity", "NaN", "0x1"])
@pytest.mark.parametrize("kind", [Number(-1e308, 1e308), Number(0.0), SECONDS])
def test_numbers_are_finite(text, kind):
    with pytest.raises(click.BadParameter):
        kind.convert(text, None, None)
    assert kind.convert("1.5", None, None) == 1.5


@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("sequence", "--start"),
        ("sequence", "--end"),
        ("sequence", "--fps"),
        ("sequence", "--exposure"),
        ("render", "--time"),
        ("render", "--exposure"),
        ("compare", "--noise"),
        ("compare", "--timeout"),
        ("convert", "--exposure"),
    ],
)
@pytest.mark.parametrize("text", ["nan", "inf", "-inf"])
def test_every_number_of_the_command_line_is_finite(command, option, text, capsys, tmp_path):
    place = [str(tmp_path / "out.png")] if command == "convert" else ["-o", str(tmp_path / "o.png")]
    assert run([command, "builtin:cornell", *place, f"{option}={text}"]) == 2
    assert f"Invalid value for '{option}'" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_shared_settings_go_where_they_are_known():
    given = {"iterations": "4", "resolution": "8"}
    found = shared_settings(("lpv", "direct", "nope"), Scene(), given)
    assert found == {"lpv": given, "direct": {"resolution": "8"}, "nope": {}}
    with pytest.raises(SettingsError, match="techniques direct: unknown setting 'iterations'"):
        shared_settings(("direct",), Scene(), given)
    assert shared_settings(("nope",), Scene(), given) == {"nope": {}}
