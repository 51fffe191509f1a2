"""Opening a user's file: the one place where that is done.

Only regular files are read: a pipe, a socket or a device may block, or never end. What a scene
file may name is one rule for all kinds of them, `named_file`.
"""

from __future__ import annotations

import os
import re
import stat
import struct
import threading
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
_OF_THE_SYSTEM = (("/", "proc"), ("/", "sys"))
"""Where files are made up as they are read: some block, some never end."""
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


_CONFINED: dict[Path, int] = {}
"""Folders of files that strangers sent, and how often each is confined."""
_CONFINING = threading.Lock()


@contextmanager
def confined_to(folder: Path) -> Iterator[None]:
    """In the block files of this folder name no files outside of it, in any thread."""
    real = folder.resolve()
    with _CONFINING:
        _CONFINED[real] = _CONFINED.get(real, 0) + 1
    try:
        yield
    finally:
        with _CONFINING:
            _CONFINED[real] -= 1
            if not _CONFINED[real]:
                del _CONFINED[real]


def bound_of(folder: Path) -> Path | None:
    """The folder outside of which files of `folder` may name none; None: any of the machine.

    That is AIRLIGHT_ROOT where it is set, or `folder` itself where that lies elsewhere; and what
    `confined_to` says.
    """
    own, chosen = folder.resolve(), env.value("AIRLIGHT_ROOT")
    with _CONFINING:
        bounds = [folder for folder in _CONFINED if own.is_relative_to(folder)]
    if chosen:
        root = Path(chosen).resolve()
        bounds.append(root if own.is_relative_to(root) else own)
    # Of folders around each other the innermost holds.
    return max(bounds, key=lambda bound: len(bound.parts), default=None)


def named_file(name: str, where: object, start: Path, owner: Path | None = None) -> Path:
    """The file that the scene file `where` calls `name`, seen from the folder `start`.

    The rule of every kind of scene file: a name may lead down and up and through links, or be a
    whole path; backslashes separate as slashes do. SceneError is raised for what no scene needs
    and a stranger could mean: names of devices, shares of other machines (to open one tells them
    who asks), files that the system makes up, and what `bound_of` the folder `owner` (`start`)
    leaves out. Whoever opens the file refuses pipes and devices (`regular_file`).
    """
    plain = _plain_name(name, where)
    if plain.parts[:1] == ("//",):
        raise SceneError(
            f"it names '{name}', which lies on another machine",
            where=where,
            remedy="Copy the file to this one.",
        )
    if PureWindowsPath(name).drive and os.name != "nt":
        raise SceneError(
            f"it names '{name}', which is a path of Windows",
            where=where,
            remedy="Name the file by a path relative to this one.",
        )
    check_named(start / plain, name, where, owner or start)
    return start / plain


def check_named(path: Path, name: str, where: object, owner: Path) -> None:
    """Raise SceneError where `path`, links followed, is nothing that `named_file` would give.

    For readers that find files in ways of their own: `name` is what the file `where` says, `owner`
    its folder.
    """
    real, bound = _resolved(path, name, where), bound_of(owner)
    if real.parts[:2] in _OF_THE_SYSTEM:
        raise SceneError(f"it names '{name}', which is a file of the system", where=where)
    if bound is not None and not real.is_relative_to(bound):
        raise SceneError(
            f"it names '{name}', which is outside of '{bound}'",
            where=where,
            remedy="Copy the file into that folder, or let AIRLIGHT_ROOT be one around both.",
        )


def inside(root: Path, name: str, where: object) -> Path:
    """The part called `name` of the container that the folder `root` is, in it or below.

    `name` is what the file `where` says; backslashes separate as slashes do. Raises SceneError for
    one that leads out of the folder, by links, too, and for names of devices.
    """
    plain = _plain_name(name, where)
    outside = SceneError(
        f"it names '{name}', which is outside its folder",
        where=where,
        remedy="Copy the file beside it.",
    )
    if plain.is_absolute() or PureWindowsPath(name).drive:
        raise outside
    # The file itself, wherever links lead, has to lie in the folder.
    path = _resolved(root / plain, name, where)
    if not path.is_relative_to(root.resolve()):
        if ".." in plain.parts:
            raise outside
        raise SceneError(
            f"it names '{name}', a link to '{path}', which is outside its folder",
            where=where,
            remedy=outside.remedy,
        )
    return path


def _plain_name(name: str, where: object) -> PurePosixPath:
    """With slashes alone. Raises SceneError for names that no other system could open."""
    plain = PurePosixPath(name.replace("\\", "/"))
    for part in plain.parts:
        if _WINDOWS_DEVICE.fullmatch(part):
            raise SceneError(
                f"it names '{name}', which is a device under Windows",
                where=where,
                remedy="Call the file otherwise.",
            )
    return plain


def _resolved(path: Path, name: str, where: object) -> Path:
    """The file itself, wherever links lead."""
    try:
        return path.resolve()
    except (OSError, ValueError, RuntimeError):  # a loop of links, or a null byte
        raise SceneError(f"it names '{name}', which is no file", where=where) from None


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
