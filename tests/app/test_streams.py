"""Full and closed streams: one message, or none, and the conventional exit codes."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from airlight.app.streams import ClosedPipe, guarded, say
from airlight.errors import OutputError

posix = pytest.mark.skipif(os.name != "posix", reason="POSIX pipes")
COMMAND = [sys.executable, "-m", "airlight"]


class Broken:
    encoding, errors = "utf-8", "strict"

    def __init__(self, number: int) -> None:
        self.number = number

    def write(self, text: str) -> int:
        raise OSError(self.number, os.strerror(self.number))

    flush = write


def test_streams_fail_in_words(monkeypatch):
    monkeypatch.setattr(sys, "stdout", Broken(28))
    monkeypatch.setattr(sys, "stderr", Broken(32))
    with guarded():
        with pytest.raises(OutputError, match=r"standard output cannot be written \(No space"):
            print("x")
        with pytest.raises(ClosedPipe):
            print("x", file=sys.stderr)
        assert sys.stdout.encoding == "utf-8"
    say("nobody hears it")
    assert isinstance(sys.stdout, Broken)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
@pytest.mark.parametrize("words", [["scenes"], ["--help"], ["scenes", "--json"]])
def test_a_full_standard_output_is_one_message(words):
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [*COMMAND, *words], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 2
    assert done.stderr == ("error: standard output cannot be written (No space left on device)\n")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
def test_a_full_standard_error_changes_no_exit_code():
    with Path("/dev/full").open("wb") as full:
        assert subprocess.call([*COMMAND, "validate", "none.toml"], stderr=full) == 2


@posix
@pytest.mark.parametrize("words", [["scenes"], ["--help"]])
def test_a_closed_pipe_is_quiet(words):
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [*COMMAND, *words], stdout=writing, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, "")
