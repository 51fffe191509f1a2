"""One input tried in this process: what it did, and whether that is a failure.

Every input must give a scene, an image or a light field, or one AirlightError whose message is
one line. Failures are anything else: another exception, more processor time or memory than so
small a file can justify, a message of several lines or with control characters, a storm of
warnings, a written file, or a file read that the input had no right to name.
"""

from __future__ import annotations

import contextlib
import io
import os
import resource
import signal
import sys
import traceback
import warnings
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

from airlight.errors import AirlightError
from airlight.scene.io.files import confined_to

from . import seeds
from .targets import Case

SECONDS = 4.0
"""Processor time that an input of some kilobytes may take."""
GROWTH_BYTES = 512 << 20
"""Memory that the process may grow by in one input."""
MOST_WARNINGS = 100
LONGEST_MESSAGE = 2000
SECRETS: seeds.Files = {
    "secret.ply": seeds.PLY,
    "secret.obj": seeds.OBJ,
    "secret.npy": seeds.npy(seeds.smoke()),
}


@dataclass(frozen=True)
class Failure:
    """What went wrong: its kind, where in our code, and a line or more of words."""

    kind: str
    where: str
    text: str

    @property
    def group(self) -> tuple[str, str]:
        """Failures of one group are taken for the same mistake."""
        return self.kind, self.where


class TooLong(BaseException):
    """Raised by the timer into whatever is running; no `except Exception` hears it."""


_HEARD: list[list[tuple[str, str]]] = []
"""Where files that are opened now are listed, as ("read" or "written", name), if anywhere."""


def _hear(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "open" and _HEARD and isinstance(arguments[0], (str, bytes)):
        flags = arguments[2] or 0
        kind = "written" if flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT) else "read"
        _HEARD[-1].append((kind, os.fsdecode(arguments[0])))


sys.addaudithook(_hear)  # Python never lets go of one: there is one for all


class Ground:
    """A folder that inputs are written to and tried in, and what the process does meanwhile.

    Traps lie in it: a FIFO, a folder, links to a device and to itself. Beside it lies a folder
    `outside` with files that a scene may not read while it is kept within its own, as half are.
    """

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        self.folder, self.outside = self.root / "in", self.root / "outside"
        self.outside.mkdir(parents=True)
        for name, raw in SECRETS.items():
            (self.outside / name).write_bytes(raw)
        (self.outside / "secret.png").write_bytes(seeds.image("PNG"))
        self.folder.mkdir()
        os.mkfifo(self.folder / "fifo")
        (self.folder / "link").symlink_to("/dev/zero")
        (self.folder / "loop").symlink_to("loop")
        (self.folder / "folder").mkdir()
        self._laid: seeds.Files = {}

    def lay(self, case: Case) -> Path:
        """The files of a case, and nothing else but the traps."""
        for path in [path for path in self._laid if path not in case.files]:
            (self.folder / path).unlink()
            del self._laid[path]
        for name, raw in case.files.items():
            if self._laid.get(name) != raw:
                path = self.folder / name
                path.parent.mkdir(exist_ok=True)
                path.write_bytes(raw)
                self._laid[name] = raw
        return self.folder / case.main

    def attempt(self, case: Case) -> Failure | None:
        """Try a case. None where it went as it should."""
        path = self.lay(case)
        is_kept = zlib.crc32(case.files.get(case.main, b"")) % 2 == 0
        before = set(self.folder.iterdir())
        said, printed = [], io.StringIO()
        touched: list[tuple[str, str]] = []
        used, peak = cpu_seconds(), peak_bytes()
        failure: Failure | None = None
        try:
            with (
                _limited(),
                warnings.catch_warnings(record=True) as heard,
                contextlib.ExitStack() as held,
            ):
                if is_kept:
                    held.enter_context(confined_to(self.folder))
                warnings.simplefilter("always")
                with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
                    _HEARD.append(touched)
                    said = _opened(path, case.how)
        except AirlightError as error:
            failure = _of_message(str(error), error)
        except TooLong as error:
            failure = Failure("time", _place(error), f"more than {SECONDS:g} s of processor time")
        except BaseException as error:
            failure = Failure(type(error).__name__, _place(error), _told(error))
        finally:
            _HEARD.clear()
        return (
            failure
            or self._of_files(set(self.folder.iterdir()) - before, touched, path, is_kept)
            or _of_lines([*said, *printed.getvalue().split("\n")])
            or _of_count(printed.getvalue().count("warning: "))
            or _of_python([str(w.message) for w in heard], [w.filename for w in heard])
            or _of_use(cpu_seconds() - used, peak_bytes() - peak)
        )

    def _of_files(
        self, new: set[Path], touched: list[tuple[str, str]], path: Path, is_kept: bool
    ) -> Failure | None:
        written = [*map(str, sorted(new)), *(name for kind, name in touched if kind == "written")]
        written = [name for name in written if name != os.devnull and "__pycache__" not in name]
        if written:
            return Failure("a written file", path.suffix, ", ".join(written))
        strange = [name for _, name in touched if self._is_strange(name, is_kept)]
        return Failure("a file outside", path.suffix, ", ".join(strange)) if strange else None

    def _is_strange(self, name: str, is_kept: bool) -> bool:
        """A device, or a file that lies beside the folder that the input is kept within."""
        real = os.path.realpath(name)
        is_device = real.startswith(("/dev/", "/proc/", "/sys/")) and "random" not in real
        return is_device or (is_kept and real.startswith((str(self.outside), "/etc/passwd")))


def _opened(path: Path, how: str) -> list[str]:
    """Open a file as `how` says; the warnings of the scene."""
    if how == "light field":
        from airlight import LightField

        LightField.load(path)
        return []
    if how != "load":
        from airlight.app.cli import airlight

        command, *options = how.split()
        airlight.main([command, str(path), *options], standalone_mode=False)
        return []
    from airlight.scene.io import load

    scene = load(path)
    _ = scene.bounds
    if scene.animation is not None:
        scene.at(scene.animation.start_s + 0.3)
    return list(scene.warnings)


def _of_message(text: str, error: BaseException) -> Failure | None:
    place = _place(error)
    if "memory" in text and "GPU" not in text:
        return Failure("memory", place, text)
    if not text.isprintable():
        return Failure("a message of several lines or with control characters", place, repr(text))
    if len(text) > LONGEST_MESSAGE:
        return Failure("a message without an end", place, f"{len(text)} characters: {text[:200]}")
    return None


def _of_lines(lines: list[str]) -> Failure | None:
    """Of warnings and what a command printed."""
    for line in lines:
        if not line.isprintable():
            kind = "a line with control characters"
            return Failure(kind, _words(line), repr(line[:300]))
    return None


def _of_count(count: int) -> Failure | None:
    return Failure("a storm of warnings", "", str(count)) if count > MOST_WARNINGS else None


def _of_python(messages: list[str], files: list[str]) -> Failure | None:
    if not messages:
        return None
    place = "/".join(Path(files[0]).parts[-2:])
    return Failure("a warning of Python's", place, "; ".join(sorted(set(messages))[:3]))


def _of_use(seconds: float, grown: int) -> Failure | None:
    if seconds > SECONDS:
        return Failure("time", "", f"{seconds:.1f} s of processor time")
    if grown > GROWTH_BYTES:
        return Failure("memory", "", f"grew by {grown >> 20} MiB")
    return None


def _words(line: str) -> str:
    """What a warning says, without the names in it, to group it by."""
    return " ".join(w for w in line.split() if w.isalpha())[:60]


def _place(error: BaseException) -> str:
    """The innermost function of ours that an exception went through."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if "airlight" in Path(f.filename).parts]
    return f"{Path(ours[-1].filename).name}:{ours[-1].name}" if ours else ""


def _told(error: BaseException) -> str:
    return "".join(traceback.format_exception(error, limit=-6)).strip()[-1500:]


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    """Processor time is limited; a little more where `except` swallowed the first alarm."""

    def ring(number: int, frame: FrameType | None) -> None:
        raise TooLong

    before = signal.signal(signal.SIGPROF, ring)
    signal.setitimer(signal.ITIMER_PROF, SECONDS, 1.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def cpu_seconds() -> float:
    """Processor time of this process, user and system."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def peak_bytes() -> int:
    """The most memory that this process has had."""
    scale = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale
