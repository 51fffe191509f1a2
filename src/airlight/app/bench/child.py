"""The first image as a user gets it: a process of its own, its time and its largest memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ...errors import AirlightError, SettingsError

_TIMEOUT_S = 1800.0
_CODE = """
import json, sys
from airlight.app import cli
from airlight.app.bench import child
code = cli.run(sys.argv[1:])
print(json.dumps({"code": code, "peak_host_bytes": child.peak_host_bytes()}))
"""


def first_image(
    scene: str, size: tuple[int, int], technique: str, settings: Sequence[str], adapter: str
) -> dict[str, Any]:
    """{seconds, peak_host_bytes} of `airlight render SCENE`, imports and writing included.

    `settings` are KEY=VALUE. Raises AirlightError with the command's own message.
    """
    with tempfile.TemporaryDirectory(prefix="airlight-bench-") as folder:
        # Settings as words of the command line, so that all of the command is measured.
        words = ["render", scene, "-o", str(Path(folder) / "first.png"), "-q"]
        words += ["--size", f"{size[0]}x{size[1]}", "--technique", technique]
        words += ["--adapter", adapter]
        words += [word for text in settings for word in ("-D", text)]
        begin_s = time.perf_counter()
        done = _run(words)
        taken_s = time.perf_counter() - begin_s
    told = _told(done)
    return {"seconds": taken_s, "peak_host_bytes": told["peak_host_bytes"], "size": list(size)}


def _run(words: Sequence[str]) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(
            [sys.executable, "-c", _CODE, *words],
            capture_output=True,
            text=True,
            timeout=_TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise SettingsError(f"the first image took longer than {_TIMEOUT_S:g} s") from None


def _told(done: subprocess.CompletedProcess[str]) -> dict[str, Any]:
    # The last line is the child's own; without it the child has ended before its end.
    lines = done.stdout.splitlines()
    told = json.loads(lines[-1]) if lines and lines[-1].startswith("{") else {"code": 1}
    if told["code"] != 0:
        said = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise AirlightError(f"the first image was not made: {said.removeprefix('error: ')}")
    return dict(told)


def peak_host_bytes() -> int | None:
    """The most memory that this process has held; None where the system does not say."""
    # Linux' ru_maxrss starts at the parent's, which is not ours to report.
    status = Path("/proc/self/status")
    if status.is_file():
        for line in status.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    try:
        import resource
    except ImportError:
        return None
    unit = 1 if sys.platform == "darwin" else 1024
    return int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss) * unit
