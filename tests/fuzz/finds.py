"""Runs of many inputs, and what they found: grouped, made smaller, told with how to repeat it."""

from __future__ import annotations

import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import IO

from .shrink import shrunk
from .targets import Case, case
from .trial import Failure, Ground

HERE = Path(__file__).parent
BATCH = 400
PATIENCE_S = 120.0
"""Wall time without a new input after which a child hangs; its own timer counts work only."""


@dataclass
class Find:
    """A mistake, the inputs that show it, and the first of them made smaller."""

    loader: str
    seed: int
    failure: Failure
    numbers: list[int] = field(default_factory=list)
    smallest: Case | None = None


@dataclass
class Run:
    """What was tried of one loader, and found."""

    loader: str
    seed: int
    tried: int = 0
    finds: dict[tuple[str, str], Find] = field(default_factory=dict)

    def add(self, number: int, failure: Failure) -> None:
        """Count one more failure."""
        find = self.finds.setdefault(failure.group, Find(self.loader, self.seed, failure))
        find.numbers.append(number)


def explore(run: Run, count: int, until: float = float("inf")) -> None:
    """Try the next `count` inputs of a run's loader, or until a moment of `monotonic`."""
    end = run.tried + count
    while run.tried < end and monotonic() < until:
        for number, failure in _batch(run, min(BATCH, end - run.tried)):
            run.tried = number + 1
            if failure is not None:
                run.add(number, failure)


def _batch(run: Run, count: int) -> Iterator[tuple[int, Failure | None]]:
    """(number, failure or None) of inputs tried by one child; fewer than `count` where it ended.

    A number comes a second time, with its failure, where it failed.
    """
    heard = tempfile.TemporaryFile()  # noqa: SIM115 - closed below; a pipe would fill up
    child = subprocess.Popen(
        _command(run, count),
        stdout=subprocess.PIPE,
        stderr=heard,
        env=_environment(),
    )
    last = run.tried
    try:
        for line in _lines(child):
            if line.startswith(b"{"):
                told = json.loads(line)
                last = told.pop("number")
                yield last, Failure(**told)
            else:
                last = int(line)
                yield last, None
        code = child.wait()
        if code > 0:
            raise RuntimeError(f"input {last} of {run.loader} was not tried:\n{_last(heard)}")
        if code < 0:
            yield last, Failure(f"ended by {signal.Signals(-code).name}", "", _last(heard))
    except TimeoutError:
        yield last, Failure("hang", "", f"no answer in {PATIENCE_S:g} s")
    finally:
        child.kill()
        child.wait()
        heard.close()


def _command(run: Run, count: int) -> list[str]:
    words = [run.loader, str(run.seed), str(run.tried), str(count)]
    return [sys.executable, "-m", f"{HERE.name}.child", *words]


def _environment() -> dict[str, str]:
    paths = [str(HERE.parent), str(HERE.parents[1] / "src"), os.environ.get("PYTHONPATH", "")]
    one = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {**os.environ, **one, "PYTHONPATH": os.pathsep.join(p for p in paths if p)}


def _lines(child: subprocess.Popen[bytes]) -> Iterator[bytes]:
    """Lines of a child's stdout. Raises TimeoutError where none comes for long."""
    assert child.stdout
    held = b""
    with selectors.DefaultSelector() as selector:
        selector.register(child.stdout, selectors.EVENT_READ)
        while True:
            if not selector.select(PATIENCE_S):
                raise TimeoutError
            piece = os.read(child.stdout.fileno(), 1 << 16)
            if not piece:
                return
            *lines, held = (held + piece).split(b"\n")
            yield from lines


def _last(heard: IO[bytes]) -> str:
    heard.seek(0)
    return heard.read().decode(errors="replace")[-1500:]


def repeat(loader: str, seed: int, number: int) -> tuple[Case, Failure | None]:
    """One input again, in this process."""
    made = case(loader, seed, number)
    with tempfile.TemporaryDirectory() as folder:
        return made, Ground(Path(folder)).attempt(made)


def make_small(find: Find) -> None:
    """Shrink the first input of a find, where it does not end or slow the process."""
    made = case(find.loader, find.seed, find.numbers[0])
    kind = find.failure.kind
    if kind in ("time", "memory", "hang") or kind.startswith("ended"):
        find.smallest = made
        return
    with tempfile.TemporaryDirectory() as folder:
        ground = Ground(Path(folder))

        def fails(smaller: Case) -> bool:
            failure = ground.attempt(smaller)
            return failure is not None and failure.group == find.failure.group

        find.smallest = shrunk(made, fails)


def told(find: Find) -> str:
    """A find in words, with the command that repeats it."""
    failure, others = find.failure, len(find.numbers) - 1
    command = f"./run fuzz --loader {find.loader} --seed {find.seed} --only {find.numbers[0]}"
    lines = [
        f"{find.loader}: {failure.kind} in {failure.where or 'the process'}"
        + (f" ({others} more like it)" if others else ""),
        f"  again: {command}",
        *(f"  | {line}" for line in failure.text.splitlines()[-4:]),
    ]
    if find.smallest is not None:
        case_ = find.smallest
        lines.append(f"  opened by {case_.how}: {case_.main}")
        lines += [f"  {n} ({len(raw)} bytes): {raw[:160]!r}" for n, raw in case_.files.items()]
    return "\n".join(lines)


def keep(find: Find, folder: Path) -> None:
    """Write the files of a find's smallest input below `folder`."""
    if find.smallest is None:
        return
    for name, raw in find.smallest.files.items():
        path = folder / f"{find.loader}-{find.seed}-{find.numbers[0]}" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(raw)
