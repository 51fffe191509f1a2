"""Doing something again whenever a scene file, or a file that it names, is saved."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import click

from ..errors import AirlightError, SettingsError
from ..scene.io import BUILTIN_PREFIX
from ..scene.io.ledger import noted
from .streams import say
from .view.watch import INTERVAL_S, Watch


def watched(scene: str, work: Callable[[], None]) -> None:
    """`work` now and after each save, until interrupted; its errors are said, and waited out.

    Raises SettingsError for a scene that is no file.
    """
    if scene.startswith(BUILTIN_PREFIX):
        raise SettingsError("--watch is for scene files", remedy="Nobody saves a builtin scene.")
    watch = Watch(Path(scene))
    while True:
        # An error is said, and the next save may mend it.
        with noted() as files:
            try:
                work()
            except AirlightError as error:
                say(f"error: {error}")
        # Materials and textures of its models are among what was read.
        watch.follow(files.stamps)
        click.echo(f"watching {scene}; Ctrl-C ends it", err=True)
        while not watch.changed():
            time.sleep(INTERVAL_S / 2.0)
