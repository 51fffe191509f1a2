"""Standard output and standard error that report when they are full or closed."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO, cast

from ..errors import OutputError

_NAMES = {"stdout": "standard output", "stderr": "standard error"}


class ClosedPipe(Exception):
    """Whoever read standard output or standard error has gone; nobody needs to be told."""


@contextmanager
def guarded() -> Iterator[None]:
    """In the block a stream that fails raises ClosedPipe or OutputError, and no OSError.

    An OSError could as well be a file's; and click ends the process over some of them.
    """
    before = {name: getattr(sys, name) for name in _NAMES}
    try:
        # A process may lack a stream, as one without a console under Windows does.
        for name, stream in before.items():
            if stream is not None:
                setattr(sys, name, cast(TextIO, _Stream(stream, _NAMES[name])))
        yield
    finally:
        for name, stream in before.items():
            setattr(sys, name, stream)


def say(text: str) -> None:
    """A line on standard error, if that can be written."""
    with contextlib.suppress(OSError):
        print(text, file=sys.stderr, flush=True)


def let_go() -> None:
    """Give up what full or closed streams did not take, so that the interpreter ends quietly."""
    for descriptor, stream in ((1, sys.stdout), (2, sys.stderr)):
        try:
            if stream is not None:
                stream.flush()
        except OSError:
            # What could not be written is dropped, or Python would try again at its end.
            with Path(os.devnull).open("wb") as nothing:
                os.dup2(nothing.fileno(), descriptor)


class _Stream:
    """A text stream whose writing fails in words; all else is the stream's own."""

    def __init__(self, stream: TextIO, name: str) -> None:
        self._stream, self._name = stream, name

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """As the stream's. Raises ClosedPipe, OutputError."""
        with self._said():
            return self._stream.write(text)

    def flush(self) -> None:
        """As the stream's. Raises ClosedPipe, OutputError."""
        with self._said():
            self._stream.flush()

    @contextmanager
    def _said(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            # A closed pipe is its reader's choice, any other failure is an error.
            if error.errno == errno.EPIPE:
                raise ClosedPipe from None
            raise OutputError(f"{self._name} cannot be written ({error.strerror})") from None
