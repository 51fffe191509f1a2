"""Progress on stderr: a bar on a terminal, lines elsewhere; each says how long it will take."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click

Report = Callable[[str, float], None]
"""Called with the stage's name and how much of it is done, 0 to 1."""

_LINE_EVERY_S = 15.0


@contextmanager
def progress(*, quiet: bool = False) -> Iterator[Report]:
    """Gives a function to report with; what it shows is gone from a terminal afterwards."""
    # Bars need a terminal; in a log each stage is a line.
    if quiet:
        yield lambda stage, fraction: None
    elif sys.stderr.isatty():
        with _bar() as report:
            yield report
    else:
        yield Lines(time.monotonic).report


def spoken(seconds: float) -> str:
    """A time as it is said: 12 s, 3 min 20 s, 2 h 5 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"


class Left:
    """How long a stage will take, by what its parts so far took; `clock` in seconds."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self.stage, self.fraction = clock, "", 0.0
        self._begun_s, self._begun_at, self._noted_s = 0.0, 0.0, 0.0

    def note(self, stage: str, fraction: float) -> None:
        """The stage is so far, 0 to 1; another stage, or one that starts again, begins now."""
        self._noted_s = self._clock()
        if stage != self.stage or fraction < self.fraction:
            self.stage, self._begun_s, self._begun_at = stage, self._noted_s, fraction
        self.fraction = fraction

    @property
    def seconds(self) -> float | None:
        """The rest of the stage's time; None where nothing tells, or it is done."""
        done = self.fraction - self._begun_at
        if done <= 0.0 or self.fraction >= 1.0:
            return None
        # As fast as until the last note, less the time since then.
        wanted = (self._noted_s - self._begun_s) / done * (1.0 - self.fraction)
        return max(0.0, wanted - (self._clock() - self._noted_s))


@contextmanager
def _bar() -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
    from rich.progress import TimeElapsedColumn as Elapsed
    from rich.text import Text

    left = Left(time.monotonic)

    class LeftColumn(ProgressColumn):
        def render(self, task: Task) -> Text:
            seconds = left.seconds
            return Text("" if seconds is None else f"about {spoken(seconds)} left")

    columns = (TextColumn("{task.description:<24}"), BarColumn(), Elapsed(), LeftColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        task = bars.add_task("", total=1.0)

        def report(stage: str, fraction: float) -> None:
            left.note(stage, fraction)
            bars.update(task, description=stage, completed=fraction)

        yield report


class Lines:
    """A line for each stage, and now and then one that tells how far it is."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock, self._left, self._last_s = clock, Left(clock), clock()

    def report(self, stage: str, fraction: float) -> None:
        """A stage is so far. Only some steps are told: a line for each would fill a log."""
        now, is_new = self._clock(), stage != self._left.stage
        self._left.note(stage, fraction)
        seconds = self._left.seconds
        # A new stage is told at once; later steps of it only where it takes long.
        if is_new:
            click.echo(f"{stage} ...", err=True)
        elif now - self._last_s >= _LINE_EVERY_S and seconds is not None:
            click.echo(f"{stage} {fraction:.0%}, about {spoken(seconds)} left", err=True)
        else:
            return
        self._last_s = now
