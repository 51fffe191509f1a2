"""The propagation kernel beside hand-written C that does the same, run by run in turns."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .frames import spread

if TYPE_CHECKING:
    from ...gpu.device import Gpu

SIDES = (32, 64)
ITERATIONS = 8  # as in the C file
SETTLE_S = 0.02  # OpenMP's threads spin for a while after their work
C_FILE = Path(__file__).parents[4] / "benchmarks" / "propagate.c"
C_FLAGS = ("-O3", "-march=native", "-fopenmp", "-ffast-math")


def measure(gpu: Gpu, runs: int, sides: tuple[int, ...] = SIDES) -> dict[str, Any]:
    """Milliseconds of 8 iterations per lattice side, without and with blockers, device and C.

    {"cases": [{side, is_blocked, device_ms, c_ms, ratio_min, ratio_median}], "c": how it was
    compiled, or why it is missing}; without C its fields are left out.
    """
    with tempfile.TemporaryDirectory(prefix="airlight-bench-") as folder:
        program, said = compiled(Path(folder))
        cases = [
            _case(gpu, program, side, blocked, runs) for side in sides for blocked in (False, True)
        ]
    return {"iterations": ITERATIONS, "c": said, "cases": cases}


def compiled(folder: Path, c_file: Path | None = None) -> tuple[Path | None, str]:
    """The C program made in `folder` and its compiler's line; or None and why not."""
    source = c_file or C_FILE
    compiler = next((found for name in ("cc", "gcc", "clang") if (found := shutil.which(name))), "")
    # Each thing that is missing is said, as a result without C is no failure.
    if not source.is_file():
        return None, f"skipped: benchmarks/{source.name} is not here (this is not a checkout)"
    if not compiler:
        return None, "skipped: there is no C compiler"
    # The line that is reported is the line that is run, without the folders of this machine.
    program = folder / source.stem
    line = [Path(compiler).name, *C_FLAGS, source.name, "-o", program.name]
    done = subprocess.run(
        [compiler, *C_FLAGS, str(source), "-o", str(program)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        reason = next((x for x in done.stderr.splitlines() if "error" in x), done.stderr.strip())
        return None, f"skipped: the C file does not compile here ({reason})"
    return program, " ".join(line)


def random_faces(rng: np.random.Generator, cells: int) -> NDArray[np.uint32]:
    """Blockers of `cells` cells, eight words each as lattice/face_visibility.wgsl writes them."""
    return rng.integers(0, 1 << 32, cells * 8, dtype=np.uint32)


def _case(gpu: Gpu, program: Path | None, side: int, blocked: bool, runs: int) -> dict[str, Any]:
    words = [str(side), *(["blocked"] if blocked else [])]
    with device_runner(gpu, side, blocked) as device, c_runner(program, words) as c:
        found = in_turns(device, c if program else None, runs)
    return {"side": side, "is_blocked": blocked, **found}


def in_turns(
    device: Callable[[], float], c: Callable[[], float] | None, runs: int
) -> dict[str, Any]:
    """Milliseconds of both, run by run in turns so that they see the same machine; the ratio."""
    own: list[float] = []
    theirs: list[float] = []
    # Interleaved, so that a machine that slows down slows both; in the pause OpenMP's threads
    # stop spinning.
    for index in range(2 + runs):  # the first two compile and touch the memory
        yardstick_ms = c() if c else 0.0
        if index >= 2:
            time.sleep(SETTLE_S)
        device_ms = device()
        if index >= 2:
            theirs.append(yardstick_ms)
            own.append(device_ms)
    if c is None:
        return {"device_ms": spread(own)}
    found, yardstick = spread(own), spread(theirs)
    # Ratios of the medians, and of the least times, which other work disturbs least.
    return {
        "device_ms": found,
        "c_ms": yardstick,
        "ratio_min": found["min"] / yardstick["min"],
        "ratio_median": found["median"] / yardstick["median"],
    }


@contextmanager
def device_runner(gpu: Gpu, side: int, blocked: bool) -> Iterator[Callable[[], float]]:
    """A function that propagates once on the device and returns the milliseconds it took."""
    from ...gpu.commands import Commands
    from ...gpu.memory import buffer_of
    from ...lattice.placement import Placement
    from ...lpv.propagate import Propagate
    from ...lpv.step import StepKind

    # Random power and random walls: the time of a step does not depend on their values.
    gpu, rng = gpu.scope(), np.random.default_rng(1)
    placement = Placement((0.0, 0.0, 0.0), 1.0, (side, side, side))
    cells = placement.cells
    injected = buffer_of(gpu, "injected", rng.random((3 * cells, 4), dtype=np.float32))
    faces = buffer_of(gpu, "faces", random_faces(rng, cells))
    # Walls that block reflect, too.
    kind = StepKind(is_blocked=blocked, is_reflecting=blocked)
    propagate = Propagate(gpu, placement, kind)
    commands = Commands(gpu)

    # Whole wall time, from encoding to the end of the device's work.
    def run() -> float:
        begin_s = time.perf_counter()
        propagate.encode(commands, injected, faces, ITERATIONS)
        commands.submit()
        gpu.wait()
        return (time.perf_counter() - begin_s) * 1e3

    try:
        yield run
    finally:
        gpu.release()


@contextmanager
def c_runner(program: Path | None, given: list[str]) -> Iterator[Callable[[], float]]:
    """The same for the C program, which waits for a line per run; 0 where there is none."""
    if program is None:
        yield lambda: 0.0
        return
    # The C program measures whenever it is sent a line: both are measured in turns.
    words = [str(program), "serve", *given]
    child = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert child.stdin is not None and child.stdout is not None
    asked, answered = child.stdin, child.stdout

    def run() -> float:
        asked.write("\n")
        asked.flush()
        return float(answered.readline())

    try:
        yield run
    finally:
        asked.close()
        child.wait()
        answered.close()
