"""The SCENE argument of every command: a file, or builtin:NAME."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from ..scene import Scene

MOST_WARNINGS = 60


def load_scene(text: str) -> Scene:
    """The scene that SCENE names. Raises SceneError."""
    from ..scene.io import load

    return load(text)


def show_warnings(scene: Scene) -> None:
    """What the loader dropped, replaced or approximated, one line each on stderr.

    Of very many the first, and how many more there are.
    """
    told = list(dict.fromkeys(scene.warnings))
    for warning in told[:MOST_WARNINGS]:
        click.echo(f"warning: {warning}", err=True)
    if len(told) > MOST_WARNINGS:
        click.echo(f"warning: and {len(told) - MOST_WARNINGS:,} more like these", err=True)
