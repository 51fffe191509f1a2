"""Check where a result will go before work is spent on it, and write it whole."""

from __future__ import annotations

import json
import stat
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import OutputError


def check_writable(path: Path, endings: Sequence[str] = ()) -> None:
    """Raise OutputError unless `path` has one of `endings` and can be written.

    A file that the command has read so far cannot. Called again once everything was read, it finds
    the others before any work is done for nothing.
    """
    from ..scene.io.writing import check_target

    # The ending first, as it needs no look at the disk.
    if endings and path.suffix.lower() not in endings:
        raise OutputError(
            f"cannot write an image that ends in '{path.suffix}'",
            where=path,
            remedy=f"End its name in one of {', '.join(endings)}.",
        )
    check_target(path)


def check_outputs(*paths: Path | None) -> None:
    """Raise OutputError unless all can be written, each into a file of its own; None is none."""
    from ..scene.io.ledger import check_distinct

    named = [path for path in paths if path is not None]
    for path in named:
        check_writable(path)
    check_distinct(named)


def is_folder(path: Path) -> bool:
    """Whether there is a folder at `path`; none where the path cannot be."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def check_folder(folder: Path) -> None:
    """Raise OutputError where there is something else than a folder, or none can be."""
    # A folder that is not there can be made; anything else in its place cannot.
    try:
        is_there = stat.S_ISDIR(folder.stat().st_mode)
    except FileNotFoundError:
        return
    except (OSError, ValueError) as error:
        raise _no_folder(folder, error) from None
    if not is_there:
        raise OutputError("this is a file, not a folder", where=folder)


def make_folder(folder: Path) -> None:
    """Make a folder for outputs where it is missing. Raises OutputError.

    Also where no file can be written in it: that is told before any work is done for nothing.
    """
    check_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _no_folder(folder, error) from None
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise OutputError(
            f"no file can be written in this folder ({error.strerror or error})",
            where=folder,
            remedy="Choose another folder, or check its permissions and free space.",
        ) from None


def _no_folder(folder: Path, error: Exception) -> OutputError:
    return OutputError(
        f"cannot be made a folder ({getattr(error, 'strerror', None) or error})",
        where=folder,
        remedy="Choose another place.",
    )


def write_json(values: Mapping[str, Any], path: Path) -> None:
    """Write a JSON file, whole or not at all. Raises OutputError."""
    from ..scene.io.writing import whole_file

    with whole_file(path) as part:
        part.write_text(json_text(values) + "\n", encoding="utf-8")


def json_text(values: Any) -> str:
    """Indented JSON; NumPy numbers and arrays become plain ones."""
    return json.dumps(values, indent=2, default=_plain, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON form")
