"""Opening a user's file: the one place where that is done.

Only regular files are read: a pipe, a socket or a device may block, or never end. What a file
that came from elsewhere may name lies in its own folder or below it.
"""

from __future__ import annotations

import os
import re
import stat
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import BinaryIO

import numpy as np

from ... import env
from ...errors import AirlightError, SceneError, memory_wanted, within_memory
from .ledger import note_read

_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)
SMALLER = "Make it smaller, or free some memory."
"""The remedy for what is too large for memory."""

_WINDOWS_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d|conin\$|conout\$)\s*(\..*)?", re.I)
_OF_PARSERS = (
    ValueError,
    ArithmeticError,
    LookupError,
    RecursionError,
    EOFError,
    struct.error,
    zlib.error,
    zipfile.BadZipFile,
)
"""What libraries raise for files that they did not expect. Others are mistakes of ours."""


def regular_file(path: Path) -> Path:
    """`path`, for whoever opens files by name. Raises SceneError for all but regular files.

    From now on it is an input: the command writes nothing over it.
    """
    note_read(path)
    try:
        _refuse_special(path.stat().st_mode, path)
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from None
    return path


def is_file(path: Path) -> bool:
    """Whether there is a regular file; false for names that no file system takes."""
    return _is_kind(path, stat.S_ISREG)


def is_folder(path: Path) -> bool:
    """Whether there is a folder; false for names that no file system takes."""
    return _is_kind(path, stat.S_ISDIR)


def _is_kind(path: Path, is_kind: Callable[[int], bool]) -> bool:
    try:
        return is_kind(path.stat().st_mode)
    except (OSError, ValueError):
        return False


@contextmanager
def opened(path: Path) -> Iterator[BinaryIO]:
    """A regular file to read from. Raises SceneError for one that cannot be opened or read."""
    # A device may do something when it is opened, so look first; look again at what was opened.
    regular_file(path)
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        with os.fdopen(os.open(path, flags), "rb") as stream:
            _refuse_special(os.fstat(stream.fileno()).st_mode, path)
            yield stream
    except OSError as error:
        raise _unreadable(path, error) from None


def read_bytes(path: Path) -> bytes:
    """All bytes of a regular file. Raises SceneError for one that is missing or unreadable."""
    # As many bytes as the file has; reading them may be more than memory holds.
    with opened(path) as stream:
        size = os.fstat(stream.fileno()).st_size
        with within_memory(f"its content of {size:,} bytes", where=path, kind=SceneError):
            return stream.read(size)


def read_text(path: Path) -> str:
    """The text of a UTF-8 file. Raises SceneError."""
    try:
        return read_bytes(path).decode("utf-8")
    except UnicodeDecodeError as error:
        raise SceneError(f"is not UTF-8 text (byte {error.start})", where=path) from None


def in_utf8(raw: bytes) -> bytes:
    """Text whose mark says that it is UTF-16, as some editors of Windows save it, in UTF-8."""
    for mark, codec in ((b"\xff\xfe", "utf-16-le"), (b"\xfe\xff", "utf-16-be")):
        if raw.startswith(mark):
            return raw[2:].decode(codec, "replace").encode()
    return raw


def root_around(own: Path) -> Path:
    """The folder in which a scene in the folder `own` may name files, beside that itself.

    AIRLIGHT_ROOT where that lies around it.
    """
    # A root elsewhere says nothing about this scene, whose own folder then bounds it.
    chosen = env.value("AIRLIGHT_ROOT")
    root = Path(chosen).resolve() if chosen else own
    return root if own.is_relative_to(root) else own


def inside(root: Path, name: str, where: object, start: Path | None = None) -> Path:
    """The file called `name` in the folder `root` or below it; backslashes separate as slashes do.

    `name` is what the file `where` says, seen from the folder `start` (`root`). Raises SceneError
    for one that leads out of the folder, by links, too, and for names of devices.
    """
    # Names that no other system could open.
    plain = PurePosixPath(name.replace("\\", "/"))
    for part in plain.parts:
        if _WINDOWS_DEVICE.fullmatch(part):
            raise SceneError(
                f"it names '{name}', which is a device under Windows",
                where=where,
                remedy="Call the file otherwise.",
            )
    outside = SceneError(
        f"it names '{name}', which is outside its folder",
        where=where,
        remedy="Copy the file beside it.",
    )
    if plain.is_absolute() or PureWindowsPath(name).drive:
        raise outside
    # The file itself, wherever links lead, has to lie in the folder.
    try:
        path, folder = ((start or root) / plain).resolve(), root.resolve()
    except (OSError, ValueError, RuntimeError):  # a loop of links, or a null byte
        raise SceneError(f"it names '{name}', which is no file", where=where) from None
    if not path.is_relative_to(folder):
        if ".." in plain.parts:
            raise outside
        raise SceneError(
            f"it names '{name}', a link to '{path}', which is outside its folder",
            where=where,
            remedy=outside.remedy,
        )
    return path


@contextmanager
def naming(path: object) -> Iterator[None]:
    """What goes wrong while `path` is read, as one SceneError that names it.

    What parsers raise that nobody foresaw stays its cause: AIRLIGHT_DEBUG=1 shows it. NumPy does
    not warn of numbers that are out of range: what they make is checked, and refused by name.
    """
    try:
        # NumPy's warnings of overflow would reach the user as lines without a file's name.
        with np.errstate(all="ignore"):
            yield
    # An error keeps the file that it names, which may be one that this file refers to.
    except SceneError as error:
        if error.where:
            raise
        raise SceneError(error.problem, where=path, remedy=error.remedy) from error.__cause__
    except AirlightError:
        raise
    except MemoryError as error:
        raise SceneError(
            f"does not fit into memory{memory_wanted(error)}", where=path, remedy=SMALLER
        ) from None
    except _OF_PARSERS as error:
        raise SceneError(
            f"is damaged, or of a kind that is not read ({type(error).__name__}: {error})",
            where=path,
            remedy="If other programs read it, please report it, with what AIRLIGHT_DEBUG=1 shows.",
        ) from error


def _refuse_special(mode: int, path: Path) -> None:
    if not stat.S_ISREG(mode):
        kind = next((text for test, text in _KINDS if test(mode)), "something else")
        raise SceneError(f"this is {kind}, not a file", where=path)


def _unreadable(path: Path, error: Exception) -> SceneError:
    if isinstance(error, FileNotFoundError):
        return SceneError("file not found", where=path, remedy="Check the path.")
    reason = getattr(error, "strerror", None) or error
    return SceneError(f"cannot be read ({reason})", where=path)
