"""Which files a command has read and written, so that no output replaces an input.

Whoever opens a user's file calls `note_read`; `whole_file` asks `check_output` before it writes.
Outside of `recorded` nothing is kept and nothing is refused: a program that uses the package
answers for its own files.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from ...errors import OutputError

Stamp = tuple[int, int]


def stamp_of(path: str | os.PathLike[str]) -> Stamp | None:
    """When a file was changed last, in nanoseconds, and its size; None where there is none.

    Of a folder, as a zarr store is: of all that lies in it, the latest change and the sum.
    """
    state = _state(path)
    if state is None or not stat.S_ISDIR(state.st_mode):
        return state and (state.st_mtime_ns, state.st_size)
    inside = [Path(folder, name) for folder, _, files in os.walk(path) for name in files]
    found = [state, *(held for held in map(_state, inside) if held is not None)]
    return max(held.st_mtime_ns for held in found), sum(held.st_size for held in found)


class Ledger:
    """The files that one command has read, and those that it has written."""

    def __init__(self) -> None:
        self._read: dict[str, Stamp | None] = {}
        self._written: dict[str, str] = {}

    @property
    def read(self) -> tuple[Path, ...]:
        """Absolute paths of what was read, each once, in order."""
        return tuple(map(Path, self._read))

    @property
    def stamps(self) -> dict[Path, Stamp | None]:
        """What was read, as it was when that began."""
        return {Path(path): stamp for path, stamp in self._read.items()}

    def note_read(self, path: str | os.PathLike[str]) -> None:
        """The command reads `path`."""
        absolute = str(Path(path).absolute())
        if absolute not in self._read:
            self._read[absolute] = stamp_of(absolute)

    def check_output(self, path: Path) -> None:
        """Raise OutputError where `path` is a file that was read, or another output's file."""
        # A path may be written again; another path to the same file would be two outputs in one.
        other = self._written.get(_place(path))
        if other is not None and other != str(Path(path).absolute()):
            raise _two_in_one(path, Path(other))
        if _state(path) is None:  # not there yet: not read either
            return
        # Links and other spellings of a path lead to one file, which its device and number tell.
        if any(_is_same(path, source) for source in self._read):
            raise OutputError(
                "the command reads this file, and will not write over it",
                where=path,
                remedy="Choose another name for the output.",
            )

    def note_written(self, path: Path) -> None:
        """The command has written `path`."""
        self._written[_place(path)] = str(Path(path).absolute())


_LISTENING: ContextVar[tuple[Ledger, ...]] = ContextVar("listening", default=())
_NOW: ContextVar[Ledger | None] = ContextVar("ledger", default=None)


@contextmanager
def recorded() -> Iterator[Ledger]:
    """From here to the end of the block, what is read is recorded, and never written over."""
    ledger = Ledger()
    token = _NOW.set(ledger)
    try:
        yield ledger
    finally:
        _NOW.reset(token)


@contextmanager
def noted() -> Iterator[Ledger]:
    """What is read in the block, which a command's own ledger is told, too."""
    ledger = Ledger()
    token = _LISTENING.set((*_LISTENING.get(), ledger))
    try:
        yield ledger
    finally:
        _LISTENING.reset(token)


@contextmanager
def own_files() -> Iterator[None]:
    """In the block airlight reads what it wrote itself and may write again: caches, and notes."""
    # Ledgers are out of sight for the block, and the same ones come back after it.
    token, listening = _NOW.set(None), _LISTENING.set(())
    try:
        yield
    finally:
        _NOW.reset(token)
        _LISTENING.reset(listening)


def note_read(*paths: str | os.PathLike[str]) -> None:
    """Files were read, or will be: none of them may be an output of the same command."""
    now = _NOW.get()
    for ledger in (*_LISTENING.get(), *((now,) if now else ())):
        for path in paths:
            ledger.note_read(path)


def stamps_read() -> dict[Path, Stamp | None]:
    """What the command has read so far, as it was then; nothing outside of `recorded`."""
    ledger = _NOW.get()
    return ledger.stamps if ledger else {}


def check_output(path: Path) -> None:
    """Raise OutputError where the command has read `path`, or written another output there."""
    ledger = _NOW.get()
    if ledger is not None:
        ledger.check_output(path)


def note_written(path: Path) -> None:
    """An output is at `path`."""
    ledger = _NOW.get()
    if ledger is not None:
        ledger.note_written(path)


def check_distinct(paths: Iterable[Path]) -> None:
    """Raise OutputError where two outputs of one command are one file."""
    seen: list[Path] = []
    for path in paths:
        for other in seen:
            if _place(path) == _place(other) or _is_same(path, other):
                raise _two_in_one(path, other)
        seen.append(path)


def _two_in_one(path: Path, other: Path) -> OutputError:
    beside = "" if path.absolute() == other.absolute() else f": this and '{other}'"
    return OutputError(
        f"two outputs of the command are one file{beside}",
        where=path,
        remedy="Give each output a name of its own.",
    )


def _place(path: Path) -> str:
    """One text for one place, through links, whether or not there is a file yet."""
    return os.path.normcase(os.path.realpath(path))


def _is_same(a: str | Path, b: str | Path) -> bool:
    """Whether two paths lead to one file: links, letters' case and `..` make no difference."""
    first, second = _state(a), _state(b)
    return first is not None and second is not None and os.path.samestat(first, second)


def _state(path: str | os.PathLike[str]) -> os.stat_result | None:
    try:
        return Path(path).stat()
    except (OSError, ValueError):
        return None
