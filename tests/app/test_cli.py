"""The command's frame: exit codes, one message per mistake, never a traceback."""

from __future__ import annotations

import subprocess
import sys

import click
import pytest

from airlight.app import cli
from airlight.errors import SceneError


@pytest.fixture
def raising(monkeypatch):
    """Makes `airlight doctor` raise what it is given."""

    def install(error: BaseException) -> None:
        @click.command("doctor")
        def command() -> None:
            raise error

        monkeypatch.setattr(cli._Commands, "get_command", lambda *_: command)

    return install


def test_help_lists_the_commands_without_touching_graphics():
    code = (
        "import sys; from airlight.app import cli; cli.run(['--help']); "
        "sys.exit('wgpu' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    for name in ("render", "info", "validate", "scenes", "doctor"):
        assert f"\n  {name} " in done.stdout


def test_version(capsys):
    assert cli.run(["--version"]) == 0
    assert capsys.readouterr().out == "airlight, version 0.1.0\n"


def test_python_m_airlight_is_the_command():
    """`python -m airlight` runs airlight.__main__."""
    done = subprocess.run(
        [sys.executable, "-m", "airlight", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout == "airlight, version 0.1.0\n"


def test_bad_input_is_one_message_and_exit_2(raising, capsys):
    raising(SceneError("bad", where="a.toml", remedy="Mend it."))
    assert cli.run(["doctor"]) == 2
    out, err = capsys.readouterr()
    assert (out, err) == ("", "error: a.toml: bad. Mend it.\n")


@pytest.mark.parametrize("arguments", [["nonsense"], ["render"], ["doctor", "--nonsense"]])
def test_misuse_is_exit_2(arguments, capsys):
    assert cli.run(arguments) == 2
    assert "Error: " in capsys.readouterr().err


def test_a_mistake_of_ours_is_one_line_and_exit_1(raising, capsys):
    raising(ZeroDivisionError("two\nlines"))
    assert cli.run(["doctor"]) == 1
    assert capsys.readouterr().err == (
        "internal error: ZeroDivisionError: two lines. Please report it, with the output of "
        "`airlight doctor` and of the same command under AIRLIGHT_DEBUG=1.\n"
    )


def test_debug_shows_the_traceback(raising, capsys, monkeypatch):
    monkeypatch.setenv("AIRLIGHT_DEBUG", "1")
    raising(ZeroDivisionError("x"))
    assert cli.run(["doctor"]) == 1
    assert "Traceback (most recent call last)" in capsys.readouterr().err


def test_interruption_is_130(raising, capsys):
    raising(KeyboardInterrupt())
    assert cli.run(["doctor"]) == 130
    assert capsys.readouterr().err.strip() == "interrupted"


def test_main_exits_with_the_code(raising):
    raising(SceneError("bad"))
    with pytest.raises(SystemExit) as caught:
        cli.main(["doctor"])
    assert caught.value.code == 2
