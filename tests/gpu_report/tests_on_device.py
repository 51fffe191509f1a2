"""The tests that use the device, run on each of the code paths."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from airlight.gpu.code_paths import SWITCH

REPOSITORY = Path(__file__).parents[2]
FOLDERS = (
    "gpu",
    "surface",
    "lighting",
    "lattice",
    "media",
    "lpv",
    "scatter",
    "pop",
    "techniques",
    "display",
    "rays",
    "gather",
    "area",
    "analytic",
    "maths",
    "app/view",
    "test_rendering.py",
    "test_renderers.py",
    "test_moving.py",
)
QUICK = ("gpu/test_compute.py",)
_COUNT = re.compile(r"(\d+) (passed|failed|skipped|error)")


@dataclass(frozen=True)
class Outcome:
    """How many tests passed on some paths, and which did not."""

    paths: str
    counts: dict[str, int]
    failed: tuple[str, ...]
    last_line: str

    @property
    def is_good(self) -> bool:
        """Whether some passed and none failed."""
        return bool(self.counts.get("passed")) and not self.failed


def run(paths: str, adapter: str, chosen: tuple[str, ...]) -> Outcome:
    """Run the test files and folders `chosen` on `paths` of `adapter`, in a process of its own."""
    told = subprocess.run(
        [sys.executable, "-m", "pytest", "-rfE", "--tb=no", *(f"tests/{c}" for c in chosen)],
        cwd=REPOSITORY,
        env={**os.environ, SWITCH: paths, "AIRLIGHT_ADAPTER": adapter},
        capture_output=True,
        text=True,
        check=False,
    )
    return outcome(paths, told.stdout or told.stderr)


def outcome(paths: str, text: str) -> Outcome:
    """What pytest's output says."""
    lines = text.strip().splitlines() or ["pytest said nothing"]
    counts = {kind: int(number) for number, kind in _COUNT.findall(lines[-1])}
    failed = [line.split(" ", 1)[1] for line in lines if line.startswith(("FAILED ", "ERROR "))]
    return Outcome(paths, counts, tuple(failed), lines[-1])
