"""The command's frame: exit codes, one message per mistake, never a traceback."""

from __future__ import annotations

import signal
import subprocess
import sys
import warnings

import click
import numpy as np
import PIL.Image
import pytest

from airlight.app import cli
from airlight.errors import SceneError, SettingsWarning


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


def test_a_warning_of_ours_is_one_line_and_told_once(monkeypatch, capsys):
    @click.command("doctor")
    def command() -> None:
        for _ in range(2):
            warnings.warn("setting a = 'b' is no longer there", SettingsWarning, stacklevel=1)

    monkeypatch.setattr(cli._Commands, "get_command", lambda *_: command)
    assert cli.run(["doctor"]) == 0
    assert capsys.readouterr() == ("", "warning: setting a = 'b' is no longer there\n")


def test_bad_input_is_one_message_and_exit_2(raising, capsys):
    raising(SceneError("bad", where="a.toml", remedy="Mend it."))
    assert cli.run(["doctor"]) == 2
    out, err = capsys.readouterr()
    assert (out, err) == ("", "error: a.toml: bad. Mend it.\n")


@pytest.mark.parametrize("arguments", [["nonsense"], ["render"], ["doctor", "--nonsense"]])
def test_misuse_is_exit_2(arguments, capsys):
    assert cli.run(arguments) == 2
    assert "Error: " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("rendr", "Did you mean 'render'?"),
        ("xyz", "Known: bench, compare,"),
        ("my model.obj", "To draw it: airlight render 'my model.obj' -o image.png"),
        ("builtin:room", "To draw it: airlight render builtin:room -o image.png"),
    ],
)
def test_a_word_that_is_no_command_says_what_was_meant(word, meant, capsys):
    assert cli.run([word]) == 2
    assert f"No such command '{word}'. {meant}" in capsys.readouterr().err


def test_a_mistake_of_ours_is_one_line_and_exit_1(raising, capsys):
    raising(ZeroDivisionError("two\nlines"))
    assert cli.run(["doctor"]) == 1
    assert capsys.readouterr().err == (
        "internal error: ZeroDivisionError: two lines. Please report it, with the output of "
        "`airlight doctor` and of the same command under AIRLIGHT_DEBUG=1.\n"
    )


def test_debug_shows_what_a_parser_raised(tmp_path, capsys, monkeypatch):
    from airlight.scene.io import obj

    def broken(raw, path):
        raise KeyError("unforeseen")

    monkeypatch.setattr(obj, "parse_obj", broken)
    (tmp_path / "a.obj").write_text("v 0 0 0\n")
    assert cli.run(["info", str(tmp_path / "a.obj")]) == 2
    err = capsys.readouterr().err
    assert err.startswith(f"error: {tmp_path / 'a.obj'}: is damaged, or of a kind that is not read")
    assert err.count("\n") == 1
    monkeypatch.setenv("AIRLIGHT_DEBUG", "1")
    assert cli.run(["info", str(tmp_path / "a.obj")]) == 2
    assert "KeyError: 'unforeseen'" in capsys.readouterr().err.partition("Traceback")[2]


def test_a_name_breaks_no_message_over_lines(tmp_path, capsys):
    for name in ("a\nb\x1b[2J.toml", "a" * 260, "a" * 260 + ".toml", "no\nsuch"):
        assert cli.run(["info", str(tmp_path / name)]) == 2
        err = capsys.readouterr().err
        assert err.startswith("error: ")
        assert err.count("\n") == 1
        assert err.strip().isprintable()


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
    before = signal.getsignal(signal.SIGINT)
    try:
        with pytest.raises(SystemExit) as caught:
            cli.main(["doctor"])
    finally:  # `main` expects its process to end
        signal.signal(signal.SIGINT, before)
    assert caught.value.code == 2


def test_memory_that_runs_out_is_one_message(raising, capsys):
    raising(MemoryError("Unable to allocate 3.00 GiB for an array with shape (9,) and ..."))
    assert cli.run(["doctor"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: there is not enough memory (3.00 GiB were wanted at once). Use")
    assert said.count("\n") == 1


_LIMITED = """
import resource, sys
from airlight.app import cli
resource.setrlimit(resource.RLIMIT_AS, 2 * (int(sys.argv[1]),))
sys.exit(cli.run(sys.argv[2:]))
"""


def _render_within(limit_bytes, scene, folder):
    """What `airlight render` of a scene says in so much address space, and its exit code."""
    arguments = ["render", str(scene), "-o", str(folder / "o.png"), "--size", "64x36", "-q"]
    done = subprocess.run(
        [sys.executable, "-c", _LIMITED, str(limit_bytes), *arguments, "--samples", "1"],
        capture_output=True,
        text=True,
        check=False,
    )
    return done.stderr, done.returncode


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="address space is limited on Linux alone")
@pytest.mark.parametrize("limit_gb", [0.8, 2.5])
def test_a_grid_that_does_not_fit_is_one_message(limit_gb, tmp_path):
    density = np.zeros((512, 512, 512), np.float32)
    density[200:300, 200:300, 200:300] = 1.0
    np.save(tmp_path / "large.npy", density)
    said, code = _render_within(int(limit_gb * 1e9), tmp_path / "large.npy", tmp_path)
    assert code == 2, said
    messages = ("fit into memory", "no memory is left", "of memory are left")
    assert any(message in said for message in messages), said
    assert said.count("\n") == 1


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="address space is limited on Linux alone")
def test_a_sky_that_does_not_fit_names_its_file_and_size(tmp_path):
    PIL.Image.new("RGB", (12000, 12000), (90, 120, 200)).save(tmp_path / "sky.png")
    scene = tmp_path / "scene.toml"
    scene.write_text('[environment]\nfile = "sky.png"\n[medium]\nsigma_s = 0.1\n')
    said, code = _render_within(2_500_000_000, scene, tmp_path)
    assert code == 2, said
    assert "sky.png: its image of 12000 x 12000 pixels does not fit into memory" in said
    said, code = _render_within(6_000_000_000, scene, tmp_path)
    assert code == 0, said


def test_parameters_of_mitsubas_files_are_told_from_settings(tmp_path, capsys):
    """Mitsuba's -D sets $names of a file; here --param does."""
    path = tmp_path / "a.xml"
    path.write_text('<scene version="3.0.0"><default name="spp" value="$spp"/></scene>')
    for name, has_hint in (("spp", True), ("nonsense", False)):
        words = ["render", str(path), "-o", str(tmp_path / "a.png"), "-t", "lpv", "-D"]
        assert cli.run([*words, f"{name}=16"]) == 2
        error = capsys.readouterr().err
        assert f"unknown setting '{name}'" in error
        hint = f"$spp is a parameter of {path}: --param spp=VALUE sets it."
        assert (hint in error) is has_hint
