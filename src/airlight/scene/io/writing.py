"""Writing a file whole or not at all, wherever a user may have said that it goes.

A file is written beside its place and renamed into it, so that whatever happens the old one or
the new one is there. It keeps the permissions of the one it replaces, and a link stays a link.
Character devices (/dev/null) and open descriptors (/dev/stdout, /dev/fd/N) are written through;
pipes with a name, sockets and disks are refused.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ...errors import AirlightError, OutputError
from .ledger import check_output, note_written

_STANDARD = {"/dev/stdout": 1, "/dev/stderr": 2}
_DESCRIPTOR = re.compile(r"/(?:dev|proc/self)/fd/(\d{1,9})")
_SPECIAL = {stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket", stat.S_IFBLK: "a disk"}
_CACHE_REMEDY = "Set AIRLIGHT_CACHE to a folder that can be written."
_STEM_LETTERS, _SUFFIX_LETTERS = 40, 16  # of a name that may itself be as long as names can be


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A file to write, put in the place of `path` when the block ends well, else removed.

    Raises OutputError where `path` cannot be written, or is a file that the command reads.
    """
    target = _target(path)
    if target.is_stream:
        with _streamed(path, target) as part:
            yield part
        return
    # Beside the target, so that taking its place is one step of the file system.
    part = _part(target.path)
    try:
        with _said(path):
            _create(part)
            yield part
            # The old file's owner and permissions are given before the new one takes its place.
            _inherit(part, target.state)
            part.replace(target.path)
        note_written(path)
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def check_target(path: Path) -> None:
    """Raise OutputError where `whole_file` would. Nothing is left behind."""
    target = _target(path)
    if not target.is_stream:
        # A file of no name in the same folder shows that one can be written.
        with _said(path), tempfile.TemporaryFile(dir=target.path.parent):
            pass


@dataclass(frozen=True)
class _Target:
    """Where a path leads: the file behind its links, its state (None: not there yet)."""

    path: Path
    state: os.stat_result | None
    descriptor: int | None = None

    @property
    def is_stream(self) -> bool:
        """Whether bytes are written into it, since nothing can take its place."""
        return self.descriptor is not None or (
            self.state is not None and stat.S_ISCHR(self.state.st_mode)
        )


def _target(path: Path) -> _Target:
    """Raises OutputError for what must not, or cannot, be written."""
    written = str(path.absolute())
    # Streams that are open already are written to as they are.
    found = _DESCRIPTOR.fullmatch(written)
    if written in _STANDARD or found:
        return _Target(path, None, int(found[1]) if found else _STANDARD[written])
    # A link stays, and the file behind it is replaced.
    with _said(path, ValueError):  # ValueError: a null character
        state = _state(path)
        behind = Path(os.path.realpath(path))
        folder = behind.parent if path.is_symlink() else path.parent
        is_folder = folder.is_dir()
    if not is_folder:
        raise OutputError(
            f"the folder '{folder}' does not exist", where=path, remedy="Create it first."
        )
    # What is there may be replaced, and is nothing that is read.
    if state is not None:
        _check_state(path, state)
    check_output(path)
    return _Target(behind, state)


def _state(path: Path) -> os.stat_result | None:
    try:
        return path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None


def _check_state(path: Path, state: os.stat_result) -> None:
    if stat.S_ISDIR(state.st_mode):
        raise OutputError("this is a folder, not a file", where=path)
    kind = _SPECIAL.get(stat.S_IFMT(state.st_mode))
    if kind is not None:
        raise OutputError(
            f"this is {kind}, not a file",
            where=path,
            remedy="Name a file, /dev/null or /dev/stdout.",
        )
    if not os.access(path, os.W_OK):
        raise OutputError(
            "this file is write-protected",
            where=path,
            remedy="Choose another name, or change its permissions.",
        )


def _part(target: Path) -> Path:
    """A hidden name beside `target`, short enough for every file system."""
    stem, suffix = part_words(target)
    return target.with_name(f".{stem}.{os.getpid()}.part{suffix}")


def part_words(target: Path) -> tuple[str, str]:
    """(stem, suffix) of the half-written file's name `.STEM.PID.partSUFFIX` beside `target`."""
    return target.stem[:_STEM_LETTERS], target.suffix[:_SUFFIX_LETTERS]


def _create(part: Path) -> None:
    """Create a new file: whatever had its name before is not followed."""
    part.unlink(missing_ok=True)
    os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))


def _inherit(part: Path, state: os.stat_result | None) -> None:
    """Owner and permissions of the file that is replaced, as far as they can be given."""
    if state is None:
        return
    with suppress(OSError, AttributeError):  # AttributeError: Windows has no owners
        if (os.geteuid(), os.getegid()) != (state.st_uid, state.st_gid):
            os.chown(part, state.st_uid, state.st_gid)
    with suppress(OSError):
        part.chmod(stat.S_IMODE(state.st_mode))


def keep(path: Path, what: str, write: Callable[[Path], None]) -> str:
    """Have `write(part)` create the file at `path` in the cache, whole or not at all.

    Returns an empty text, or a warning that names `what` is not cached, and why: a cache that
    cannot be written costs its user that and the same work next time, never the result.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as part:
            write(part)
    except (OSError, OutputError) as error:
        said = error.problem if isinstance(error, OutputError) else error.strerror or error
        return f"{what} is not kept for the next time: {path}: {said}. {_CACHE_REMEDY}"
    return ""


@contextmanager
def _streamed(path: Path, target: _Target) -> Iterator[Path]:
    """A file elsewhere, whose bytes are written into the device or descriptor at the end."""
    # The whole is written first: a block that fails leaves nothing in the stream.
    with tempfile.TemporaryDirectory(prefix="airlight-") as folder:
        part = Path(folder) / f"part{path.suffix[:_SUFFIX_LETTERS]}"
        yield part
        with _said(path):
            # What was printed before stands before it in the stream.
            if target.descriptor in (1, 2) and sys.stdout is not None:
                sys.stdout.flush()
            number = target.descriptor
            opened = os.open(path, os.O_WRONLY) if number is None else os.dup(number)
            with part.open("rb") as source, os.fdopen(opened, "wb") as stream:
                shutil.copyfileobj(source, stream)


@contextmanager
def _said(path: Path, *more: type[Exception]) -> Iterator[None]:
    """What the system refuses, and what of `more` is raised, as one message about `path`."""
    # RuntimeError is OpenEXR's for a full disk.
    kinds: tuple[type[Exception], ...] = (OSError, RuntimeError, *more)
    try:
        yield
    except AirlightError:
        raise
    except kinds as error:
        raise unwritable(path, error) from None


def unwritable(path: Path, error: Exception) -> OutputError:
    """The error for a `path` that the system refuses to write."""
    reason = getattr(error, "strerror", None) or error
    return OutputError(
        f"cannot be written ({reason})",
        where=path,
        remedy="Choose another folder, or check its permissions and free space.",
    )
