"""Whether the scene file, or a file beside it that it names, was written again."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...errors import SceneError
from ...scene.io.files import read_text
from ...scene.io.toml_animation import volume_files

INTERVAL_S = 0.25
_QUIET_S = 0.1  # an editor may still be writing


class Watch:
    """`changed` is true once per edit. A file that is gone for a moment is no edit."""

    def __init__(self, path: Path, clock: Callable[[], float] = time.monotonic) -> None:
        self.path, self._clock = path, clock
        self._seen = self._stamps(named_files(path))
        self._pending: tuple[dict[Path, tuple[int, int]], float] | None = None
        self._looked_s = float("-inf")

    def changed(self) -> bool:
        """Look, at most every INTERVAL_S."""
        now = self._clock()
        if now - self._looked_s < (INTERVAL_S if self._pending is None else _QUIET_S):
            return False
        self._looked_s = now
        # A change counts once it has stood for a while: editors write files in several steps.
        stamps = self._stamps(set(self._seen) | {self.path})
        if stamps == self._seen or self.path not in stamps:
            self._pending = None
            return False
        if self._pending is None or self._pending[0] != stamps:
            self._pending = (stamps, now)
            return False
        self._pending = None
        self._seen = self._stamps(named_files(self.path) | set(stamps))
        return True

    @staticmethod
    def _stamps(paths: set[Path]) -> dict[Path, tuple[int, int]]:
        # A file that is not there now has no stamp, and is looked at again.
        found = {}
        for path in paths:
            try:
                stat = path.stat()
            except OSError:
                continue
            found[path] = (stat.st_mtime_ns, stat.st_size)
        return found


def named_files(path: Path) -> set[Path]:
    """The scene file and what its `file` keys name, as far as it can be read."""
    files = {path}
    if path.suffix.lower() != ".toml":
        return files
    try:
        raw = tomllib.loads(read_text(path))
    except (SceneError, ValueError, RecursionError):
        return files
    # Environment maps, meshes, grids and groups of lights: a change of theirs is worth a redraw.
    tables: list[Any] = [raw.get("environment")]
    for name in ("mesh", "volume", "light"):
        listed = raw.get(name)
        tables += listed if isinstance(listed, list) else []
    for table in tables:
        if isinstance(table, dict) and isinstance(table.get("file"), str):
            files.add(path.parent / table["file"])
        # The grids of a sequence; one that names none yet is told when it is loaded.
        if isinstance(table, dict) and isinstance(table.get("sequence"), str):
            with suppress(SceneError):
                files.update(volume_files(table["sequence"], path.parent, ""))
    return files
