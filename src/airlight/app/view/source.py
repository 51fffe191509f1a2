"""Where a session's scene comes from: a shipped scene, or a file and those beside it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...scene.builtin import BUILTIN
from ...scene.io import BUILTIN_PREFIX, load
from ...scene.io.ledger import files_read, noted
from ...scene.scene import Scene
from .watch import Watch

_MOST_BESIDE = 40
_SCENES = (".toml", ".xml", ".glb", ".gltf", ".obj", ".ply", ".stl", ".usda", ".usdc", ".usdz")


class Source:
    """A scene and its file. `loaded` is what the file said last.

    `name` is empty for a scene that has none; `model`: the options that models are read with.
    """

    def __init__(self, name: str, loaded: Scene, model: Mapping[str, Any] | None = None) -> None:
        self.name, self.loaded, self.model = name, loaded, dict(model or {})
        is_file = bool(name) and not name.startswith(BUILTIN_PREFIX)
        self.watch = Watch(Path(name)) if is_file else None
        if self.watch is not None:
            self.watch.follow(files_read())
        self._first = Path(name).parent if is_file else None

    def again(self) -> Scene:
        """The scene as its file has it now. Raises AirlightError."""
        with noted() as files:
            try:
                return load(self.name, **self.model)
            finally:
                if self.watch is not None:
                    self.watch.follow(files.read)

    def opened(self, name: str) -> Source:
        """Another scene, with the options of this one. Raises AirlightError."""
        with noted() as files:
            made = Source(name, load(name, **self.model), self.model)
        if made.watch is not None:
            made.watch.follow(files.read)
        made._first = self._first
        return made

    def places(self) -> tuple[str, ...]:
        """What can be opened by name: this scene, files beside the first one, shipped scenes."""
        beside: list[str] = []
        if self._first is not None:
            try:
                # Files beside the first one stay in the list, whichever of them is open.
                files = sorted(p for p in self._first.iterdir() if p.suffix.lower() in _SCENES)
            except OSError:
                files = []
            beside = [str(path) for path in files[:_MOST_BESIDE]]
        shipped = [f"{BUILTIN_PREFIX}{name}" for name in BUILTIN]
        return tuple(dict.fromkeys([self.name or "(from Python)", *beside, *shipped]))
