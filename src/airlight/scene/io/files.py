"""Reading a user's file whole, and writing one whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ...errors import AirlightError, OutputError, SceneError


def read_bytes(path: Path) -> bytes:
    """All bytes of a file. Raises SceneError for one that is missing, unreadable or a folder."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise SceneError("file not found", where=path, remedy="Check the path.") from None
    except IsADirectoryError:
        raise SceneError("this is a folder, not a file", where=path) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise SceneError(f"cannot be read ({reason})", where=path) from None


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A file to write beside `path`, renamed to it when the block ends well, else removed.

    Raises OutputError where the folder is missing or cannot be written.
    """
    folder = path.parent
    if not folder.is_dir():
        raise OutputError(
            f"the folder '{folder}' does not exist", where=path, remedy="Create it first."
        )
    if path.is_dir():
        raise OutputError("this is a folder, not a file", where=path)
    part = folder / f".{path.stem}.{os.getpid()}.part{path.suffix}"
    try:
        _touch(part, path)
        yield part
        part.replace(path)
    except AirlightError:
        raise
    except (OSError, RuntimeError) as error:  # RuntimeError is OpenEXR's for a full disk
        raise _unwritable(path, error) from None
    finally:
        part.unlink(missing_ok=True)


def _touch(part: Path, path: Path) -> None:
    """Fail early, and in words, where nothing can be written."""
    try:
        part.touch()
    except OSError as error:
        raise _unwritable(path, error) from None


def _unwritable(path: Path, error: Exception) -> OutputError:
    reason = getattr(error, "strerror", None) or error
    return OutputError(
        f"cannot be written ({reason})",
        where=path,
        remedy="Choose another folder, or check its permissions and free space.",
    )
