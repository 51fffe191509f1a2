"""The SCENE argument of every command: a file, or builtin:NAME."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from ..scene import Scene


def load_scene(text: str) -> Scene:
    """The scene that SCENE names. Raises SceneError."""
    from ..scene.io import load

    return load(text)


def show_warnings(scene: Scene) -> None:
    """What the loader dropped, replaced or approximated, one line each on stderr."""
    for warning in scene.warnings:
        click.echo(f"warning: {warning}", err=True)
