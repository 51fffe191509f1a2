"""Density grids that follow each other: the files that a folder or a pattern names."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ...errors import SceneError
from . import SCENE_SUFFIXES, VOLUME_SUFFIXES
from .files import is_folder
from .volumes import is_grid_file

_WILD = "*?["
_MOST_NAMES = 3
"""Names that a message lists."""


def is_series(path: Path) -> bool:
    """Whether a path is a folder or a pattern of files, and none that is called as one file is."""
    if is_grid_file(path):
        return False
    # A folder 'room.toml' is a mistake, not a series.
    if is_folder(path):
        return path.suffix.lower() not in SCENE_SUFFIXES
    return any(sign in path.name for sign in _WILD)


def series_of(path: Path) -> tuple[Path, ...]:
    """The grids that the folder or pattern `path` names, by the numbers in their names.

    There are none where `path` is no series. Raises SceneError where it is one that names no grids,
    or grids of more than one sequence.
    """
    if not is_series(path):
        return ()
    base, pattern = (path, "*") if is_folder(path) else (path.parent, path.name)
    try:
        found = [f for f in matching(base, pattern) if f.suffix.lower() in SCENE_SUFFIXES]
    except (OSError, ValueError):  # a folder that may not be read, a name that no system takes
        found = []
    grids = [file for file in found if file.suffix.lower() in VOLUME_SUFFIXES]
    scenes = [file for file in found if file not in grids]
    if not grids:
        raise SceneError("names no density grids", where=path, remedy=_instead(path, base, scenes))
    if scenes:
        raise SceneError(
            f"names density grids (as {grids[0].name}) and other scenes (as {scenes[0].name})",
            where=path,
            remedy=f"Name one of them: '{base / ('*' + grids[0].suffix)}', or {scenes[0]}",
        )
    _refuse_mixed(path, base, grids)
    return tuple(grids)


def kind_of(path: str | Path) -> str:
    """The ending, in small letters, of a file, or of the grids that a folder or a pattern names.

    Raises SceneError as `series_of`.
    """
    files = series_of(Path(path))
    return (files[0] if files else Path(path)).suffix.lower()


def is_kind(path: str | Path, suffixes: Iterable[str]) -> bool:
    """Whether `kind_of` is one of the `suffixes`; false where it names nothing that is a scene."""
    try:
        return kind_of(path) in suffixes
    except SceneError:
        return False


def only_file(path: str | Path) -> Path:
    """`path`, or the only grid that this folder or pattern names."""
    files = series_of(Path(path))
    return files[0] if len(files) == 1 else Path(path)


def series_name(path: Path) -> str:
    """What to call the scene: a folder's name, or a pattern's without its signs."""
    if is_folder(path):
        return path.resolve().name or "grids"
    return re.sub(r"[^\w-]+", "", re.sub(r"\[.*?\]", "", path.stem)).strip("_-") or "grids"


def matching(base: Path, name: str) -> list[Path]:
    """Files, and zarr stores, of a folder whose names fit, by the numbers in them.

    Brackets are first of all those of names, as 'run[3].nc'; else one character of several.
    """
    for pattern in (name.replace("[", "[[]"), name):
        # Hidden files are parts of what is still written, and notes of file managers.
        found = [f for f in base.glob(pattern) if is_grid_file(f) and not f.name.startswith(".")]
        if found:
            return sorted(found, key=_by_numbers)
    return []


def _by_numbers(path: Path) -> tuple[Any, ...]:
    """'smoke.10' comes after 'smoke.9'."""
    return tuple((int(p), "") if p.isdigit() else (-1, p) for p in re.split(r"(\d+)", path.name))


def _refuse_mixed(path: Path, base: Path, grids: list[Path]) -> None:
    """Raise SceneError for grids whose names differ by more than their numbers."""
    series = Counter(re.sub(r"\d+", "*", file.name) for file in grids)
    if len(series) == 1:
        return
    most = series.most_common(_MOST_NAMES)
    listed = ", ".join(f"{name} ({count})" for name, count in most)
    more = len(series) - len(most)
    raise SceneError(
        f"names grids that are no sequence: {listed}{f' and {more} more' if more else ''}",
        where=path,
        remedy=f"Name those that follow each other: '{base / most[0][0]}'. In a scene file each "
        "[[volume]] has its own.",
    )


def _instead(path: Path, base: Path, scenes: list[Path]) -> str:
    """What to name in place of a `path` that names no grids."""
    if scenes:
        return f"A scene is one file: {scenes[0]}"
    # Programs that simulate put their grids into a folder below.
    try:
        below = sorted(folder for folder in base.iterdir() if folder.is_dir())
        held = next((folder for folder in below if _holds_grids(folder)), None)
    except OSError:
        held = None
    if held is not None:
        return f"Name the folder that holds them: {held}"
    if any(sign in str(path.parent) for sign in _WILD):
        return "* may stand in the name of files alone, not in that of a folder."
    return f"Grids end in {', '.join(VOLUME_SUFFIXES)}."


def _holds_grids(folder: Path) -> bool:
    return any(f.suffix.lower() in VOLUME_SUFFIXES and is_grid_file(f) for f in folder.iterdir())
