"""Check where a result will go before work is spent on it, and write it whole."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import OutputError


def check_writable(path: Path, endings: Sequence[str] = ()) -> None:
    """Raise OutputError unless `path` has one of `endings` and a file can be made beside it."""
    if endings and path.suffix.lower() not in endings:
        raise OutputError(
            f"cannot write a picture that ends in '{path.suffix}'",
            where=path,
            remedy=f"End its name in one of {', '.join(endings)}.",
        )
    if path.is_dir():
        raise OutputError("this is a folder, not a file", where=path)
    if not path.parent.is_dir():
        raise OutputError(
            f"the folder '{path.parent}' does not exist", where=path, remedy="Create it first."
        )
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise OutputError(
            f"cannot be written ({error.strerror or error})",
            where=path,
            remedy="Choose another folder, or check its permissions and free space.",
        ) from None


def write_json(values: Mapping[str, Any], path: Path) -> None:
    """Write a JSON file, whole or not at all. Raises OutputError."""
    from ..scene.io.files import whole_file

    with whole_file(path) as part:
        part.write_text(json_text(values) + "\n", encoding="utf-8")


def json_text(values: Any) -> str:
    """Indented JSON; NumPy numbers and arrays become plain ones."""
    return json.dumps(values, indent=2, default=_plain, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON form")
