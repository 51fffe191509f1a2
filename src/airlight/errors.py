"""What airlight raises, and nothing else reaches a user.

    AirlightError              one message: where, what is wrong, what to do
    ├── SceneError             a scene file, a mesh, an image, a volume or a value in one is bad
    ├── SettingsError          a technique, a setting or an option is unknown or impossible
    ├── DeviceError            no graphics driver; too large for the device or for memory
    │   └── ShaderError        our own WGSL does not compile: file and line of the real source
    ├── OutputError            an image cannot be written
    └── ReferenceFailure       the reference renderer is missing, crashed or ran past its time

Each message is complete on its own: it names the file, the key and the remedy.
The command line prints it and exits with 2. A SettingsWarning stops nothing: a value of a setting
that is no longer there, and what is done instead.
"""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

# NumPy's words, with the memory that was wanted.
_WANTED = re.compile(r"Unable to allocate (\S+ \S+) for an array")

LONGEST_LINE = 1500
"""Characters of a message; a file's names and numbers may have millions."""


def one_line(text: str) -> str:
    """`text` as a terminal can show it: what cannot be printed escaped, a long middle left out.

    Files from elsewhere may hold line breaks, control characters and texts of any length where
    names are, and messages quote them.
    """
    # Both ends of a long message say most.
    if len(text) > LONGEST_LINE:
        text = f"{text[: LONGEST_LINE // 2]} ... {text[-LONGEST_LINE // 4 :]}"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


class AirlightError(Exception):
    """Bad input or a missing capability, said in one line.

    `problem` is what is wrong; `where` the file (and line or key) it is wrong in;
    `remedy` what the user can do about it.
    """

    def __init__(self, problem: str, *, where: object = "", remedy: str = "") -> None:
        self.problem = problem
        self.where = str(where)
        self.remedy = remedy
        super().__init__(problem)

    def __str__(self) -> str:
        # Parts may quote files: each is made printable, and as short as a line.
        parts = (self.where, self.problem, self.remedy)
        where, problem, remedy = (one_line(part) for part in parts)
        text = f"{where}: {problem}" if where else problem
        return f"{text}. {remedy}" if remedy else text


class SceneError(AirlightError):
    """A scene file, or something it names, cannot be used."""


class SettingsError(AirlightError):
    """A technique, setting or option is unknown or impossible."""


class SettingsWarning(UserWarning):
    """A setting has a value that is no longer there, and is taken as another one."""


class DeviceError(AirlightError):
    """There is no usable graphics device, or it is too small for what was asked.

    Also where it was lost, a process was forked from the device's, and a Renderer is closed or
    used by two threads at once.
    """


class ShaderError(DeviceError):
    """WGSL of ours that does not compile; the message points into its real file, line by line."""

    def __str__(self) -> str:
        return f"{self.where}: {self.problem}"


class OutputError(AirlightError):
    """A result cannot be written where it was asked for."""


class ReferenceFailure(AirlightError):
    """The reference renderer is missing, refused the scene, crashed or ran out of time."""


def memory_wanted(error: MemoryError) -> str:
    """ " (... were wanted)" of an error in which NumPy says how much it asked for, and else ""."""
    # NumPy says how much it wanted, Python does not.
    found = _WANTED.match(str(error))
    return f" ({found[1].replace('. ', ' ')} were wanted at once)" if found else ""


@contextmanager
def within_memory(
    what: str, *, where: object = "", remedy: str = "", kind: type[AirlightError] = AirlightError
) -> Iterator[None]:
    """`what` (a noun in the singular) is done inside; memory that runs out becomes a `kind`."""
    try:
        yield
    except MemoryError as error:
        raise kind(
            f"{what} does not fit into memory{memory_wanted(error)}", where=where, remedy=remedy
        ) from None


def nearest(name: object, known: Iterable[str]) -> str:
    """A remedy naming the known name closest to `name`, and else all of them."""
    # A slip of the pen has one remedy; else everything that is known is named.
    names = sorted(known)
    return _meant(name, names) or (f"Known: {', '.join(names)}." if names else "")


def left_out(what: str, name: str, known: Iterable[str]) -> str:
    """A warning that `name` is unknown, with the known name closest to it, if one is close."""
    asked = _meant(name, known)
    return f"the {what} '{name[:40]}' is unknown and left out{f'. {asked}' if asked else ''}"


def _meant(name: object, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(str(name), list(known), n=1)
    return f"Did you mean '{close[0]}'?" if close else ""


class Kinds:
    """Warnings of which many may be alike: each kind is told once, with how many more there are."""

    def __init__(self) -> None:
        self._first: dict[Any, str] = {}
        self._count: Counter[Any] = Counter()

    def note(self, key: Any, text: str) -> None:
        """One more of the kind `key`."""
        self._first.setdefault(key, text)
        self._count[key] += 1

    def texts(self) -> list[str]:
        """The first of each kind."""
        more = {key: f" (and {n - 1:,} more)" if n > 1 else "" for key, n in self._count.items()}
        return [text + more[key] for key, text in self._first.items()]
