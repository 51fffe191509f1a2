"""Grids that follow each other as a bare file, folder or pattern has them: a scene that moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..animation import Animation
from ..animation.density import VolumeTrack
from ..scene import Scene
from .grid_times import frames_of
from .netcdf_times import name_and_number
from .volumes import VolumeGrid, grid_names


@dataclass(frozen=True)
class Series:
    """Files that follow each other, how a message calls them, their times a second, and when the
    first is shown, seconds."""

    files: tuple[Path, ...]
    name: str
    fps: float
    start_s: float = 0.0


def with_times(
    scene: Scene,
    series: Series,
    grid: VolumeGrid,
    keys: Mapping[str, Any],
    beside: Mapping[str, Any],
) -> Scene:
    """The scene as a sequence of its files and their times, if those are several; told is how many
    a second, as nobody has said it.

    `grid`: the one that the scene shows at rest; `beside`: the keys of a [[volume]] that name what
    lies beside its density.
    """
    from .toml_animation import file_sequence

    file, is_one = Path(scene.volumes[0].source), len(series.files) == 1
    name = keys.get("grid", "density")
    # A number behind the name asks for one time, of what lies beside the density, too.
    if is_one and name_and_number(name, [])[1] is not None and name not in grid_names(file):
        return _alone(scene, file, keys)
    # What lies beside the density changes with it.
    glowing = beside.get("emission_grid", beside.get("temperature_grid"))
    colours = {"albedo": beside["albedo_grid"]} if "albedo_grid" in beside else {}
    files, times = frames_of(series.files, name, colours, glowing)
    if len(files) == 1:
        return _alone(scene, file, keys)
    asked = {
        "sequence_fps": series.fps,
        "sequence_start_s": series.start_s,
        "grid": name,
        "channels": keys.get("channels", "density"),
    }
    sequence = file_sequence(asked, files, times, grid, glowing, colours)
    # Nobody asked for a sequence: it is told, and how to see the rest of it.
    what = "its times" if is_one else f"{len(files):,} grids"
    text = f"{series.name}: {what} follow each other {series.fps:g} a second (--sequence-fps N "
    text += "for another number; airlight sequence and --time show them)"
    text += "" if is_one else f"; {file.name} is shown, the fullest of a few"
    # A frame for each time.
    moving = Animation((VolumeTrack(0, sequence),), fps=series.fps)
    return replace(scene, animation=moving, warnings=(*scene.warnings, text))


def _alone(scene: Scene, file: Path, keys: Mapping[str, Any]) -> Scene:
    """The scene of one grid; what was asked for that others would need is told."""
    if "sequence_fps" not in keys:
        return scene
    told = f"{file.name}: sequence_fps is left out, as one grid is shown and none follows it"
    return replace(scene, warnings=(*scene.warnings, told))
