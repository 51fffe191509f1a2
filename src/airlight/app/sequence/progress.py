"""How far a sequence is, and how long it will take: a bar on a terminal, lines elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

import click

from ..progress import spoken

_LINE_EVERY_S = 10.0


@contextmanager
def counted(
    what: str, total: int, done: int = 0, *, quiet: bool = False
) -> Iterator[Callable[[], None]]:
    """Gives a function to call after each of `total`, of which `done` were there before."""
    # Bars need a terminal; in a log a line now and then will do.
    if quiet:
        yield lambda: None
    elif sys.stderr.isatty():
        with _bar(what, total, done) as count:
            yield count
    else:
        yield Lines(what, total, done, monotonic).count


@contextmanager
def _bar(what: str, total: int, done: int) -> Iterator[Callable[[], None]]:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        MofNCompleteColumn(),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    # Frames may take minutes each: the rate is of all of them so far.
    with Progress(
        *columns, console=Console(stderr=True), transient=True, speed_estimate_period=86400.0
    ) as bars:
        task = bars.add_task(what, total=total, completed=done)
        yield lambda: bars.update(task, advance=1)


class Lines:
    """A line at first, every ten seconds, and at the end; `clock` in seconds."""

    def __init__(self, what: str, total: int, done: int, clock: Callable[[], float]) -> None:
        self.what, self.total, self.before, self.done = what, total, done, done
        self._clock, self._began_s = clock, clock()
        self._last_s = self._began_s
        if done:
            click.echo(f"{done} of {total} {what} were there", err=True)

    def count(self) -> None:
        """One more is done."""
        self.done += 1
        now = self._clock()
        # The first frame tells how long one takes, the last ends the count.
        is_due = now - self._last_s >= _LINE_EVERY_S or self.done in (self.before + 1, self.total)
        if is_due:
            self._last_s = now
            # Frames that were there before say nothing of how long one takes.
            spent = now - self._began_s
            left = spent / (self.done - self.before) * (self.total - self.done)
            tail = f", {spoken(left)} left" if self.done < self.total else f" in {spoken(spent)}"
            click.echo(f"{self.done} of {self.total} {self.what}{tail}", err=True)
