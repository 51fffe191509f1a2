"""Propagation to 26 neighbours beside hand-written C that does the same, run by run in turns."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .kernel import SIDES, c_runner, compiled, in_turns

if TYPE_CHECKING:
    from ...gpu.device import Gpu

ITERATIONS = 8  # as in the C file
C_FILE = Path(__file__).parents[4] / "benchmarks" / "scatter.c"
SIGMA_S, SIGMA_T = (0.27, 0.24, 0.2), (0.3, 0.3, 0.25)  # m^-1, with cells of 1 m


def measure(gpu: Gpu, runs: int, sides: tuple[int, ...] = SIDES) -> dict[str, Any]:
    """Milliseconds of 8 iterations per lattice side, device and C; as bench_kernel.measure."""
    with tempfile.TemporaryDirectory(prefix="airlight-bench-") as folder:
        program, said = compiled(Path(folder), C_FILE)
        cases = [_case(gpu, program, side, runs) for side in sides]
    return {"iterations": ITERATIONS, "c": said, "cases": cases}


def c_numbers() -> list[str]:
    """What the C program is given of `step_rows`: M of three channels, T of them, rho/length."""
    from ...maths.lattice26 import RHO, hops
    from ...scatter.coefficients import step_rows

    numbers: list[float] = []
    for row in step_rows(SIGMA_S, SIGMA_T, 1.0):
        # Without walls the kernel counts a cell's own hops together.
        numbers += [*row["even"], *row["direct"]]
    lengths = hops().lengths[[0, 6, 18]]
    return [f"{value:.9g}" for value in (*numbers, *(RHO / lengths))]


def _case(gpu: Gpu, program: Path | None, side: int, runs: int) -> dict[str, Any]:
    with device_runner(gpu, side) as device, c_runner(program, [str(side), *c_numbers()]) as c:
        found = in_turns(device, c if program else None, runs)
    return {"side": side, "is_blocked": False, **found}


@contextmanager
def device_runner(gpu: Gpu, side: int) -> Iterator[Callable[[], float]]:
    """A function that propagates once on the device and returns the milliseconds it took."""
    from ...gpu.commands import Commands
    from ...gpu.memory import buffer_of
    from ...scatter.levels import Levels
    from ...scatter.schedule import schedule

    gpu, count = gpu.scope(), (side, side, side)
    rng = np.random.default_rng(1)
    source = buffer_of(gpu, "source", rng.random((3 * side**3, 4), dtype=np.float32))
    plan = schedule("none", ITERATIONS, count)
    levels = Levels(gpu, count, 1.0, plan, is_blocked=False, is_varied=False)
    levels.set_air(SIGMA_S, SIGMA_T)
    commands = Commands(gpu)

    def run() -> float:
        begin_s = time.perf_counter()
        levels.encode(commands, source)
        commands.submit()
        gpu.wait()
        return (time.perf_counter() - begin_s) * 1e3

    try:
        yield run
    finally:
        gpu.release()
