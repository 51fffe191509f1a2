"""The fuzzer hears of everything that it is to hear of."""

from __future__ import annotations

import io
import signal
import sys
import warnings

import numpy as np
import pytest

from airlight.errors import SceneError
from fuzz import finds, trial
from fuzz.finds import Find, Run, explore, told
from fuzz.shrink import shrunk
from fuzz.targets import Case
from fuzz.trial import Failure, Ground

CASE = Case({"a.gltf": b"{}"}, "a.gltf")


@pytest.fixture
def attempt(tmp_path, monkeypatch):
    """attempt(opens, name="a.gltf") -> what the fuzzer says of a loader that does `opens(path)`."""
    ground = Ground(tmp_path)

    def tried(opens, name="a.gltf", raw=b"{}"):
        monkeypatch.setattr(trial, "_opened", lambda path, how: opens(path) or [])
        return ground.attempt(Case({name: raw}, name))

    return tried


class Loud(SceneError):
    """Says what it is told as it is, which no error of airlight's does any more."""

    def __str__(self):
        return self.problem


def raises(error):
    def opens(path):
        raise error

    return opens


def test_a_scene_or_one_line_is_no_failure(attempt):
    assert attempt(lambda path: ["a warning"]) is None
    assert attempt(raises(SceneError("is bad", where="a", remedy="Mend it."))) is None


@pytest.mark.parametrize("error", [KeyError("x"), RecursionError(), MemoryError(), SystemExit(3)])
def test_any_other_exception(attempt, error):
    assert attempt(raises(error)).kind == type(error).__name__


@pytest.mark.parametrize("text", ["two\nlines", "\x1b[2J", "\u202egnp", "\ud800"])
def test_messages_and_warnings_of_several_lines(attempt, text):
    kind = "a message of several lines or with control characters"
    assert attempt(raises(Loud(text))).kind == kind
    assert attempt(lambda path: [text]).kind == "a line with control characters"


def test_messages_and_warnings_without_an_end(attempt):
    assert attempt(raises(Loud("x" * 9999))).kind == "a message without an end"
    assert attempt(lambda path: print("warning: w\n" * 500)).kind == "a storm of warnings"


def test_a_loop(attempt, monkeypatch):
    def opens(path):
        while True:
            pass

    monkeypatch.setattr(trial, "SECONDS", 0.2)
    assert attempt(opens).kind == "time"


def test_memory(attempt, monkeypatch):
    assert attempt(raises(SceneError("does not fit into memory"))).kind == "memory"
    monkeypatch.setattr(trial, "GROWTH_BYTES", 1 << 20)
    monkeypatch.setattr(trial, "peak_bytes", iter([0, 2 << 20]).__next__)
    assert attempt(lambda path: None).kind == "memory"


def test_files_written_and_files_outside(attempt):
    def writes(path):
        (path.parent / "more").write_text("x")

    assert attempt(writes).kind == "a written file"
    assert attempt(lambda path: (path.parent / "more").unlink()) is None

    def strays(path):
        (path.parents[1] / "outside" / "secret.png").read_bytes()

    # A scene is kept within its folder or not, by its content.
    kinds = {getattr(attempt(strays, raw=bytes([k])), "kind", None) for k in range(8)}
    assert kinds == {"a file outside", None}

    def device(path):
        with (path.parent / "link").open("rb") as stream:
            stream.read(1)

    assert attempt(device).kind == "a file outside"


def test_what_python_warns_of(attempt):
    assert attempt(lambda path: warnings.warn("overflow", RuntimeWarning, stacklevel=1)).kind == (
        "a warning of Python's"
    )
    assert attempt(lambda path: np.float32(1e30) * np.float32(1e30) and None).kind == (
        "a warning of Python's"
    )


def test_files_of_the_last_input_are_gone(tmp_path):
    ground = Ground(tmp_path)
    ground.lay(Case({"a.obj": b"", "f/b.mtl": b""}, "a.obj"))
    ground.lay(Case({"a.obj": b"x"}, "a.obj"))
    assert (ground.folder / "a.obj").read_bytes() == b"x"
    assert not (ground.folder / "f" / "b.mtl").exists()
    assert (ground.folder / "link").is_symlink()


def test_a_failing_input_becomes_small():
    big = Case({"a.obj": b"v 1 2 3\n" * 50 + b"BAD" + b"f 1 2 3\n" * 50, "b.mtl": b"x"}, "a.obj")
    small = shrunk(big, lambda case: b"BAD" in case.files["a.obj"])
    assert small.files == {"a.obj": b"BAD"}


@pytest.mark.parametrize(
    ("code", "kind"),
    [
        (f"import os; os.kill(os.getpid(), {int(signal.SIGSEGV)})", "ended by SIGSEGV"),
        ("import time; time.sleep(60)", "hang"),
    ],
)
def test_an_input_that_kills_or_stops_its_process_is_named(monkeypatch, code, kind):
    commands = iter([f"print(0); print(1, flush=True); {code}", "print(2)", "print(3)"])
    monkeypatch.setattr(finds, "PATIENCE_S", 2.0)
    monkeypatch.setattr(
        finds, "_command", lambda run, count: [sys.executable, "-c", next(commands)]
    )
    run = Run("toml", 1)
    explore(run, 4)
    assert run.tried == 4
    assert {group: find.numbers for group, find in run.finds.items()} == {(kind, ""): [1]}


def test_a_mistake_of_the_fuzzers_own_is_no_find(monkeypatch):
    monkeypatch.setattr(finds, "_command", lambda *_: [sys.executable, "-c", "raise ValueError(7)"])
    with pytest.raises(RuntimeError, match="ValueError: 7"):
        explore(Run("toml", 1), 4)


def test_a_find_says_how_to_repeat_it(tmp_path):
    find = Find("gltf", 7, Failure("KeyError", "gltf.py:load", "KeyError: 'x'"), [12, 40], CASE)
    text = told(find)
    assert "./run fuzz --loader gltf --seed 7 --only 12" in text
    assert "(1 more like it)" in text and "KeyError: 'x'" in text and "a.gltf (2 bytes)" in text
    finds.keep(find, tmp_path)
    assert (tmp_path / "gltf-7-12" / "a.gltf").read_bytes() == b"{}"


def test_commands_are_heard_too(tmp_path):
    ground = Ground(tmp_path)
    quad = Case({"s.toml": b'[[mesh]]\nshape = "quad"\n'}, "s.toml")
    for how in ("validate", "info", "info --json"):
        assert ground.attempt(Case(quad.files, quad.main, how)) is None
    assert isinstance(sys.stdout, io.TextIOBase)
