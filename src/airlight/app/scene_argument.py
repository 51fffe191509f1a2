"""The SCENE argument of every command: a file, or builtin:NAME."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from ..scene import Scene

MOST_WARNINGS = 60


def load_scene(text: str, model: Mapping[str, Any] | None = None) -> Scene:
    """The scene that SCENE names, `model` as `model_options` gives it. Raises SceneError."""
    from ..scene.io import load

    return load(text, **(model or {}))


def reads(*texts: str) -> None:
    """Say before a scene is loaded that it will be: no output may take its file's place."""
    from ..scene.io import BUILTIN_PREFIX
    from ..scene.io.grid_series import is_series, series_of
    from ..scene.io.ledger import note_read

    for text in (text for text in texts if not text.startswith(BUILTIN_PREFIX)):
        # Other files of a folder are no inputs.
        path = Path(text)
        note_read(*(series_of(path) if is_series(path) else (path,)))


def show_warnings(scene: Scene, doubts: Sequence[str] = ()) -> None:
    """What the loader dropped, replaced or approximated, and `doubts`, one line each on stderr."""
    warn((*scene.warnings, *doubts))


def warn(texts: Sequence[str]) -> None:
    """One line each on stderr. Of very many the first, and how many more there are."""
    # The same warning is told once, whatever raised it many times.
    told = list(dict.fromkeys(texts))
    for text in told[:MOST_WARNINGS]:
        click.echo(f"warning: {text}", err=True)
    if len(told) > MOST_WARNINGS:
        click.echo(f"warning: and {len(told) - MOST_WARNINGS:,} more like these", err=True)
