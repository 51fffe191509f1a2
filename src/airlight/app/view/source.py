"""Where a session's scene comes from: a shipped scene, or a file and those beside it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...scene.builtin import BUILTIN
from ...scene.io import BUILTIN_PREFIX, SCENE_SUFFIXES, VOLUME_SUFFIXES, load
from ...scene.io.ledger import Stamp, noted, stamps_read
from ...scene.io.model_options import fitting_options, left_open
from ...scene.scene import Scene
from .watch import Watch

_MOST_BESIDE = 40
_SCENES = tuple(suffix for suffix in SCENE_SUFFIXES if suffix not in (".npy", ".npz"))
"""Arrays of NumPy may be anything."""


class Source:
    """A scene and its file. `loaded` is what the file said last.

    `name` is empty for a scene that has none; `model`: the options that models are read with.
    `left_open`: which of up and scale the file leaves open, or were asked for.
    `read`: the files that it was loaded from, as they were then; else what the command has read.
    """

    def __init__(
        self,
        name: str,
        loaded: Scene,
        model: Mapping[str, Any] | None = None,
        read: Mapping[Path, Stamp | None] | None = None,
    ) -> None:
        self.name, self.loaded, self.model = name, loaded, dict(model or {})
        is_file = bool(name) and not name.startswith(BUILTIN_PREFIX)
        # Files are as they were when they were read: what was saved since is an edit.
        self.watch = Watch(Path(name), read=read or stamps_read()) if is_file else None
        self._first = Path(name).parent if is_file else None
        self.left_open = self._left_open()

    def again(self) -> Scene:
        """The scene as its file has it now. Raises AirlightError."""
        with noted() as files:
            try:
                return load(self.name, **fitting_options(self.name, self.model))
            finally:
                if self.watch is not None:
                    self.watch.follow(files.stamps)

    def opened(self, name: str) -> Source:
        """Another scene, with those options of this one that its kind has. Raises AirlightError."""
        return self._read(name, self.model)

    def read_as(self, **model: Any) -> Source:
        """The same scene, read with these options. Raises AirlightError."""
        return self._read(self.name, {**self.model, **model})

    def _read(self, name: str, model: Mapping[str, Any]) -> Source:
        with noted() as files:
            loaded = load(name, **fitting_options(name, model))
        made = Source(name, loaded, model, files.stamps)
        made._first = self._first
        return made

    def _left_open(self) -> tuple[str, ...]:
        if self.watch is None:
            return ()
        asked = fitting_options(self.name, self.model)
        found = left_open(self.name, self.loaded.warnings)
        return tuple(name for name in ("up", "scale") if name in found or name in asked)

    def places(self) -> tuple[str, ...]:
        """What can be opened by name: this scene, files beside the first one, shipped scenes."""
        beside: list[str] = []
        if self._first is not None:
            try:
                # Files beside the first one stay in the list, whichever of them is open.
                # Scenes and models before grids, of which a sequence may have thousands.
                files = sorted(
                    (p for p in self._first.iterdir() if p.suffix.lower() in _SCENES),
                    key=lambda p: (p.suffix.lower() in VOLUME_SUFFIXES, p),
                )
            except OSError:
                files = []
            beside = [str(path) for path in files[:_MOST_BESIDE]]
        shipped = [f"{BUILTIN_PREFIX}{name}" for name in BUILTIN]
        return tuple(dict.fromkeys([self.name or "(from Python)", *beside, *shipped]))
