"""Exports of the viewer: images, and the scene as a file."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from ...errors import AirlightError, OutputError
from ...scene.io.toml_text import scene_text
from ...scene.io.writing import whole_file
from .session import Session

Copy = Callable[[str], None]
_NAME_LETTERS = 60  # of up to four bytes: file names end at 255


class Saver:
    """Writes into `folder` under names that are not taken; `copy` puts text on a clipboard, `ask`
    opens the desktop's dialog for a file.

    What goes wrong becomes the session's message.
    """

    def __init__(
        self,
        session: Session,
        folder: Path,
        copy: Copy | None = None,
        ask: Callable[[], None] | None = None,
    ) -> None:
        self.session, self.folder, self._copy, self._ask = session, folder, copy, ask

    @property
    def can_ask(self) -> bool:
        """Whether there is a dialog for files."""
        return self._ask is not None

    def ask(self) -> None:
        """Open the dialog."""
        assert self._ask
        self._ask()

    @property
    def can_copy(self) -> bool:
        """Whether there is a clipboard."""
        return self._copy is not None

    def save_image(self, suffix: str) -> Path | None:
        """The image as .png or .exr (with its layers); its path, or None and a message."""
        try:
            image = self.session.image()
            path = self._free(suffix)
            image.save(path)
        except AirlightError as error:
            self._refused(error)
            return None
        return self._done(path)

    def save_scene(self) -> Path | None:
        """The scene file of what is seen; its path, or None and a message."""
        try:
            path = self._free(".toml")
            text = self._text(self.folder)
            with whole_file(path) as part:
                part.write_text(text, encoding="utf-8")
        except AirlightError as error:
            self._refused(error)
            return None
        return self._done(path)

    def copy_scene(self) -> None:
        """The scene file's text onto the clipboard, its paths relative to the file's folder."""
        source = Path(self.session.source.name)
        try:
            text = self._text(source.parent if source.suffix else self.folder)
        except (AirlightError, OSError, ValueError) as error:
            self._refused(AirlightError(str(error)))
            return
        assert self._copy
        self._copy(text)
        state = self.session.state
        state.message, state.notice = "", "the scene file is on the clipboard"

    def _text(self, folder: Path) -> str:
        s = self.session
        # Settings that were chosen here; those of the file are copied with it.
        chosen = {s.state.technique: s.state.chosen_settings} if s.state.chosen_settings else {}
        return scene_text(
            s.scene_now(),
            s.source.loaded,
            s.source.name or "builtin:scene",
            folder,
            chosen,
            s.source.model,
        )

    def _free(self, suffix: str) -> Path:
        """The first path of the scene's name that is not taken."""
        name = self.session.state.scene.name or "scene"
        # Letters that every file system takes, and a number that is free.
        safe = "".join(c if c.isalnum() or c in "-_" else "-" for c in name[:_NAME_LETTERS])
        for number in range(1, 10_000):
            path = self.folder / f"{safe}-view-{number:04d}{suffix}"
            if not os.path.lexists(path):  # what a broken link leads to is not made either
                return path
        raise OutputError("ten thousand images are here already", where=self.folder)

    def _refused(self, error: AirlightError) -> None:
        self.session.state.message, self.session.state.notice = str(error), ""

    def _done(self, path: Path) -> Path:
        self.session.state.message, self.session.state.notice = "", f"saved {path}"
        return path
