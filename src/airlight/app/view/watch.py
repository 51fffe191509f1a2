"""Whether the scene file, or one of the files that it is made of, was written again."""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...errors import SceneError
from ...scene.io.files import read_text
from ...scene.io.grid_series import is_series, series_of
from ...scene.io.ledger import Stamp, stamp_of
from ...scene.io.toml_animation import volume_files

INTERVAL_S = 0.25
_QUIET_S = 0.1  # an editor may still be writing
_REST = 10.0  # times as long as a look takes: zarr stores have thousands of files
_Stamps = dict[Path, Stamp | None]


class Watch:
    """`changed` is true once per edit. A file that is gone for a moment is no edit."""

    def __init__(
        self,
        path: Path,
        clock: Callable[[], float] = time.monotonic,
        read: Mapping[Path, Stamp | None] | None = None,
    ) -> None:
        self.path, self._clock = path, clock
        self._seen = {**self._stamps(named_files(path)), **(read or {})}
        self._pending: tuple[_Stamps, float] | None = None
        self._looked_s, self._rest_s = float("-inf"), INTERVAL_S

    def follow(self, read: Mapping[Path, Stamp | None]) -> None:
        """Look at these, too: what was read when the scene was loaded, as textures of its models.

        They are as they were when they were read, so that what is saved during a long image is an
        edit; those that are followed already are as they were when they were looked at last.
        """
        self._seen = {**read, **self._seen}

    def changed(self) -> bool:
        """Look, at most every INTERVAL_S; less often at what takes long to look at."""
        now = self._clock()
        if now - self._looked_s < (self._rest_s if self._pending is None else _QUIET_S):
            return False
        self._looked_s, began = now, time.monotonic()
        # A change counts once it has stood for a while: editors write files in several steps.
        # Of a folder or a pattern files may come and go.
        is_many = is_series(self.path)
        own = named_files(self.path) if is_many else {self.path}
        stamps = self._stamps(set(self._seen) | own)
        self._rest_s = max(INTERVAL_S, _REST * (time.monotonic() - began))
        if stamps == self._seen or (not is_many and stamps[self.path] is None):
            self._pending = None
            return False
        if self._pending is None or self._pending[0] != stamps:
            self._pending = (stamps, now)
            return False
        self._pending = None
        self._seen = {**self._stamps(named_files(self.path)), **stamps}
        return True

    @staticmethod
    def _stamps(paths: set[Path]) -> _Stamps:
        # A file that is not there now has no stamp, and is looked at again.
        return {path: stamp_of(path) for path in paths}


def named_files(path: Path) -> set[Path]:
    """The scene file and what its `file` keys name, as far as it can be read.

    Of a folder or a pattern the grids that it names now.
    """
    if is_series(path):
        with suppress(SceneError):
            return {*series_of(path)}
        return set()
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
