"""Progress on stderr: a bar on a terminal, a line per stage elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click

Report = Callable[[str, float], None]
"""Called with the stage's name and how much of it is done, 0 to 1."""


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
        yield _lines()


@contextmanager
def _bar() -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description:<24}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bars:
        task = bars.add_task("", total=1.0)

        def report(stage: str, fraction: float) -> None:
            bars.update(task, description=stage, completed=fraction)

        yield report


def _lines() -> Report:
    shown: list[str] = []

    def report(stage: str, fraction: float) -> None:
        # Only stages are told: a line for each step would fill a log.
        if shown[-1:] != [stage]:
            shown.append(stage)
            click.echo(f"{stage} ...", err=True)

    return report
