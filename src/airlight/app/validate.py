"""`airlight validate`: whether a scene could be rendered, without rendering it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from ..errors import AirlightError, SettingsError
from .outputs import json_text
from .scene_argument import load_scene, show_warnings
from .scene_options import model_options, sun_option

if TYPE_CHECKING:
    from ..scene import Scene


@click.command("validate")
@click.argument("file")
@click.option("--json", "as_json", is_flag=True, help="For a machine to read.")
@model_options()
@sun_option()
def command(file: str, as_json: bool, model: dict[str, Any]) -> None:
    """Load FILE and everything it names, and check every value. Exit 2 where one is bad."""
    # As rendering would read it, and files that it would read later.
    try:
        scene = load_scene(file, model)
        check_techniques(scene, file)
        check_sequences(scene)
    except AirlightError as error:
        # Programs get the refusal as a value, and the exit code as everyone.
        if as_json:
            click.echo(json_text(_refusal(file, error)))
        raise
    if as_json:
        click.echo(json_text({"file": file, "valid": True, "warnings": list(scene.warnings)}))
        return
    show_warnings(scene)
    click.echo(f"{file}: valid")


def check_techniques(scene: Scene, file: str) -> None:
    """Raise SettingsError for an unknown technique or setting under [technique.NAME]."""
    if not scene.settings:
        return
    from ..techniques import checked_settings

    for name in scene.settings:
        try:
            checked_settings(name, scene, {})
        except SettingsError as error:
            where = f"{file}: [technique.{name}]"
            raise SettingsError(error.problem, where=where, remedy=error.remedy) from None


def check_sequences(scene: Scene) -> None:
    """Read every file of the scene's density sequences. Raises SceneError."""
    from ..scene.animation.density import VolumeTrack
    from ..scene.animation.file_sequence import FileSequence

    for track in scene.animation.tracks if scene.animation else ():
        if isinstance(track, VolumeTrack) and isinstance(track.density, FileSequence):
            track.density.check()


def _refusal(file: str, error: AirlightError) -> dict[str, Any]:
    return {
        "file": file,
        "valid": False,
        "where": error.where,
        "problem": error.problem,
        "remedy": error.remedy,
    }
