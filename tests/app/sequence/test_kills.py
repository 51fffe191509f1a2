"""Sequences killed at seeded moments, and gone on with, end in the bytes of an undisturbed run."""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="SIGKILL"),
]
SCENE = """
[camera]
position = [0, 1, 4]
target = [0, 0.5, 0]
exposure_stops = 0
key = [{ time_s = 0, position = [0, 1, 4] }, { time_s = 1, position = [2, 1, 3] }]
[[mesh]]
shape = "box"
translate = [0, 0.5, 0]
[[light]]
type = "directional"
direction = [0.5, -1, -0.3]
irradiance = 5
[animation]
fps = 10
"""
ASKED = [
    "-t",
    "direct",
    "--size",
    "16x16",
    "--samples",
    "1",
    "--frames",
    "6",
    "-q",
    "-D",
    "resolution=8",
    "-D",
    "shadow_resolution=64",
    "-D",
    "surfels=500",
]
KILLS = 8
POLL_S = 0.001


def started(scene: Path, output: Path, more: list[str]) -> subprocess.Popen[bytes]:
    words = ["sequence", str(scene), "-o", str(output), *ASKED, "--resume", *more]
    return subprocess.Popen([sys.executable, "-m", "airlight", *words], stdout=subprocess.DEVNULL)


def written(folder: Path) -> set[tuple[str, int]]:
    """Names and sizes of all that the output is made of so far, half-written files too."""
    found = set()
    for place, _, names in os.walk(folder):
        for name in names:
            file = Path(place) / name
            try:
                found.add((str(file), file.stat().st_size))
            except FileNotFoundError:  # renamed in between
                continue
    return found


def hashes(folder: Path) -> dict[str, str]:
    """By names relative to the folder; what says how it was made (sequence.json) included."""
    return {
        str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(folder.rglob("*"))
        if file.is_file()
    }


def killed(child: subprocess.Popen[bytes], folder: Path, steps: int, delay_s: float) -> bool:
    """Kill the child `delay_s` after what it wrote changed `steps` times; False: it had ended."""
    before = written(folder)
    while steps > 0 and child.poll() is None:
        time.sleep(POLL_S)
        now = written(folder)
        steps, before = steps - (now != before), now
    time.sleep(delay_s)
    if child.poll() is None:
        child.send_signal(signal.SIGKILL)
    return child.wait() == -signal.SIGKILL


@pytest.mark.parametrize(
    ("name", "more"),
    [
        ("out", []),
        ("out", ["--format", "exr", "--layers"]),
        pytest.param("out.mp4", [], marks=pytest.mark.needs("av")),
    ],
    ids=["png", "exr", "mp4"],
)
def test_killed_and_resumed_runs_end_in_the_same_bytes(gpu, tmp_path, name, more):
    scene = tmp_path / "turn.toml"
    scene.write_text(SCENE)
    (tmp_path / "whole").mkdir()
    (tmp_path / "cut").mkdir()
    assert started(scene, tmp_path / "whole" / name, more).wait() == 0
    expected = hashes(tmp_path / "whole")
    assert len(expected) == (1 if name == "out.mp4" else 7)

    # Early kills fall into the first frames, later ones into the last and into the encoding.
    rng = np.random.default_rng(len(expected) + len(more))
    kills = 0
    for attempt in range(KILLS):
        child = started(scene, tmp_path / "cut" / name, more)
        steps, delay_s = int(rng.integers(1, 4 + attempt)), float(rng.uniform(0.0, 0.01))
        if not killed(child, tmp_path / "cut", steps, delay_s):
            assert child.returncode == 0
            break
        kills += 1
    assert kills > 0
    assert started(scene, tmp_path / "cut" / name, more).wait() == 0
    assert hashes(tmp_path / "cut") == expected
