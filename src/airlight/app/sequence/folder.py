"""The folder that a sequence's frames are in, and how a broken-off one goes on.

Every frame appears whole or not at all, under its own number. `sequence.json` says what was asked,
so frames of another scene or of other settings never come between.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...errors import OutputError, SceneError
from ...scene.io.files import read_text
from ...scene.io.ledger import check_output, own_files
from ...scene.io.writing import part_words
from ..outputs import json_text, write_json
from .plan import Plan
from .whole import is_whole

MANIFEST = "sequence.json"
_FRAME = re.compile(r"frame-(\d{5,7})\.(png|exr)")
_PART = re.compile(r"\.(?:frame-\d{5,7}|sequence)\.(\d+)\.part\.(?:png|exr|json)")
_ENOUGH = "Choose another folder, or delete this one."
_MOST_SAID, _MOST_STOPS = 100, 1000.0


class FrameFolder:
    """Frames of one sequence in one folder. Raises OutputError wherever it cannot go on."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.manifest: dict[str, Any] = {}

    def open(self, asked: Mapping[str, Any], *, resume: bool) -> None:
        """Make the folder, or take up the sequence in it, which must be what is `asked` now."""
        # Frames without a manifest may be anybody's; they are neither taken up nor written over.
        self._make()
        found = sorted(f.name for f in self.path.iterdir() if _FRAME.fullmatch(f.name))
        if (self.path / MANIFEST).exists() and (found or resume):
            self._take_up(asked, len(found), resume=resume)
        else:
            if found:
                raise OutputError(
                    f"holds {found[0]}, but no {MANIFEST} that says what it shows",
                    where=self.path,
                    remedy=_ENOUGH,
                )
            self.note(asked=dict(asked))
        self._sweep()

    def note(self, **more: Any) -> None:
        """Keep something about the sequence in its `sequence.json`."""
        self.manifest |= more
        write_json(self.manifest, self.path / MANIFEST)

    def file(self, plan: Plan, frame: int) -> Path:
        """Where a frame is, or will be."""
        return self.path / f"frame-{frame:05d}{plan.ending}"

    def missing(self, plan: Plan) -> list[int]:
        """The frames of the plan that are not there, or not whole. None of them may be an input.

        Raises OutputError.
        """
        missing = [frame for frame in plan.frames if not is_whole(self.file(plan, frame))]
        # A frame that is made must not take the place of a file that the scene reads.
        for frame in missing:
            check_output(self.file(plan, frame))
        return missing

    @property
    def metered_stops(self) -> float | None:
        """The exposure that all frames share; None where each is exposed as the camera says."""
        stops: float | None = self.manifest["metered_stops"]
        return stops

    def clear(self) -> None:
        """Remove the frames and the notes about them; the folder, too, unless more is in it."""
        # What a person has put beside the frames stays.
        for file in self.path.iterdir() if self.path.is_dir() else ():
            if _FRAME.fullmatch(file.name) or file.name == MANIFEST:
                file.unlink(missing_ok=True)
        with suppress(OSError):
            self.path.rmdir()

    def _make(self) -> None:
        try:
            self.path.mkdir(exist_ok=True)
        except FileExistsError:
            raise OutputError("is a file, not a folder for frames", where=self.path) from None
        except FileNotFoundError:
            raise OutputError(
                f"the folder '{self.path.parent}' does not exist",
                where=self.path,
                remedy="Create it first.",
            ) from None
        except OSError as error:
            raise OutputError(
                f"cannot be made ({error.strerror or error})",
                where=self.path,
                remedy="Choose another folder, or check its permissions and free space.",
            ) from None

    def _take_up(self, asked: Mapping[str, Any], count: int, *, resume: bool) -> None:
        self.manifest = _read(self.path / MANIFEST)
        there = self.manifest["asked"]
        # Frames of another run are not mixed in without being asked for.
        if not resume:
            raise OutputError(
                f"holds a sequence already ({count} frames)",
                where=self.path,
                remedy="Go on with it by --resume, or choose another folder.",
            )
        # A resumed sequence must be the one that was begun, or its frames would not fit each
        # other.
        now = json.loads(json_text(asked))
        for name in [*now, *there]:
            if now.get(name) != there.get(name):
                raise OutputError(
                    f"holds another sequence: {_difference(name, there.get(name), now.get(name))}",
                    where=self.path,
                    remedy=_ENOUGH,
                )

    def _sweep(self) -> None:
        """Remove what killed runs left half-written."""
        _sweep(self.path, _PART)


def sweep_video(path: Path) -> None:
    """Remove what killed runs left of the video at `path`, which they had not written whole."""
    stem, suffix = part_words(path)
    _sweep(path.parent, re.compile(rf"\.{re.escape(stem)}\.(\d+)\.part{re.escape(suffix)}"))


def _sweep(folder: Path, parts: re.Pattern[str]) -> None:
    """Remove files whose names are like `parts`, and whose process (its first group) has ended."""
    for file in folder.iterdir():
        part = parts.fullmatch(file.name)
        if part and not _is_alive(int(part[1])):
            file.unlink(missing_ok=True)


def _difference(name: str, there: Any, now: Any) -> str:
    if name == "scene":
        return "the scene, or a file it names, has changed"
    return f"its {name} is {_short(there)}, here it is {_short(now)}"


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= _MOST_SAID else text[:_MOST_SAID] + " ..."


def _read(path: Path) -> dict[str, Any]:
    """A `sequence.json`, with what it must hold. Raises OutputError where it is damaged."""
    try:
        with own_files():
            held = json.loads(read_text(path))
    except (SceneError, ValueError, RecursionError):
        held = None
    # Only what later code relies on, each of its kind.
    if not (
        isinstance(held, dict)
        and isinstance(held.get("asked"), dict)
        and _is_stops(held.get("metered_stops"))
        and isinstance(devices := held.get("devices", []), list)
        and all(isinstance(device, str) for device in devices)
    ):
        raise OutputError("is damaged", where=path, remedy=_ENOUGH)
    return held


def _is_stops(value: Any) -> bool:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return value is None or (is_number and abs(value) <= _MOST_STOPS)


def _is_alive(pid: int) -> bool:
    """Whether a process of that number runs here; True where that cannot be known."""
    # Signal 0 asks for the process and sends nothing; not so outside of POSIX.
    if os.name != "posix":
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
