"""Run one Mitsuba job in a child process and turn all that can go wrong into one error."""

from __future__ import annotations

import importlib.util
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ReferenceFailure
from .mitsuba_llvm import find_llvm
from .mitsuba_process import SCALAR_VARIANT, Job

LLVM_VARIANT = "llvm_ad_rgb"
LAST_LINES = 4

Progress = Callable[[float], None]


class LlvmFailure(ReferenceFailure):
    """The child died before it had compiled anything: its LLVM does not work."""


def choose_variant(said: str = "auto") -> str:
    """The Mitsuba variant to render with. Raises ReferenceFailure without Mitsuba."""
    if importlib.util.find_spec("mitsuba") is None:
        raise ReferenceFailure(
            "Mitsuba is not installed", remedy="Type: pip install 'airlight[reference]'"
        )
    if said != "auto":
        return said
    return LLVM_VARIANT if find_llvm() else SCALAR_VARIANT


def run_job(
    job: Job, folder: Path, *, timeout_s: float, progress: Progress | None
) -> dict[str, NDArray[Any]]:
    """The job's result arrays; `folder` is scratch space that the caller removes.

    Raises ReferenceFailure for a refused scene, a crash or running past `timeout_s`, and of it
    LlvmFailure where the compiled variant dies at its start.
    """
    deadline = time.monotonic() + timeout_s
    # The child reads the job from a file and tells its progress over a pipe.
    job_file = folder / "job.json"
    job.write(job_file)
    error_file = folder / "stderr.txt"
    with error_file.open("wb") as errors:
        child = subprocess.Popen(
            [sys.executable, "-m", "airlight.reference.mitsuba_process", str(job_file)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
            env=_environment(),
            start_new_session=True,
        )
    try:
        is_ready = _follow(child, deadline, timeout_s, progress)
        code = child.wait()
    finally:
        _end(child)

    # A child that ends well has left its result whole.
    if code == 0 and Path(job.result).exists():
        with np.load(job.result) as arrays:
            return dict(arrays)
    # Only a compiled variant dies before it is ready: another variant can be tried.
    if not is_ready and code < 0 and job.variant == LLVM_VARIANT:
        raise LlvmFailure(
            "Mitsuba's compiled variant does not start: its LLVM does not work",
            remedy="Install libLLVM 19 and name it in DRJIT_LIBLLVM_PATH.",
        )
    raise ReferenceFailure(_what_happened(code, error_file))


def _follow(
    child: subprocess.Popen[bytes], deadline: float, timeout_s: float, progress: Progress | None
) -> bool:
    """Pass progress on until the child closes its output. Whether it got ready."""
    # Lines are read on a thread, because reading a pipe cannot time out on every system.
    lines: queue.Queue[bytes | None] = queue.Queue()
    threading.Thread(target=_read, args=(child, lines), daemon=True).start()
    is_ready = False
    while True:
        try:
            line = lines.get(timeout=max(0.0, deadline - time.monotonic()))
        except queue.Empty:
            raise ReferenceFailure(
                f"Mitsuba took longer than {timeout_s:g} s",
                remedy="Lower spp or the size, or raise timeout_s.",
            ) from None
        if line is None:
            return is_ready
        # The child says that it is ready only once its compiler has worked: a crash before is one
        # of LLVM.
        word, _, rest = line.decode(errors="replace").strip().partition(" ")
        is_ready = is_ready or word == "ready"
        if word == "progress" and progress is not None:
            progress(float(rest))


def _read(child: subprocess.Popen[bytes], lines: queue.Queue[bytes | None]) -> None:
    assert child.stdout is not None
    for line in child.stdout:
        lines.put(line)
    lines.put(None)


def _environment() -> dict[str, str]:
    """Ours, with airlight importable and the chosen libLLVM named."""
    package_root = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(p for p in (package_root, os.environ.get("PYTHONPATH")) if p)
    environment = {**os.environ, "PYTHONPATH": path}
    llvm = find_llvm()
    if llvm is not None:
        environment["DRJIT_LIBLLVM_PATH"] = str(llvm)
    return environment


def _end(child: subprocess.Popen[bytes]) -> None:
    """Stop the child and what it started; close our ends of its pipes."""
    # The child leads a session of its own: what it started ends with it.
    if child.poll() is None:
        if hasattr(os, "killpg"):
            os.killpg(child.pid, signal.SIGKILL)
        else:
            child.kill()
        child.wait()
    for pipe in (child.stdin, child.stdout):
        if pipe is not None:
            pipe.close()


def _what_happened(code: int, error_file: Path) -> str:
    text = error_file.read_text(errors="replace").splitlines()
    # A Python traceback ends in the error itself; what stands before it helps no user.
    starts = [n for n, line in enumerate(text) if re.match(r"\w+(Error|Exception): ", line)]
    text = text[starts[-1] :][:LAST_LINES] if starts else text[-LAST_LINES:]
    said = " | ".join(line.strip() for line in text if line.strip())
    if code == -9:  # SIGKILL, which Windows lacks
        how = "was killed, perhaps for want of memory"
    elif code < 0:
        how = f"crashed ({signal.Signals(-code).name})"
    else:
        how = "refused the scene"
    return f"Mitsuba {how}: {said}" if said else f"Mitsuba {how}"
