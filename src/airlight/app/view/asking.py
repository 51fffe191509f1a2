"""The desktop's dialog for a file, beside a window that goes on drawing."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from typing import Any

from ...scene.io import SCENE_SUFFIXES
from .canvas import CanvasView
from .document import MAP_SUFFIXES

_LOOK_S = 0.1
_PROGRAMS = ("zenity", "kdialog", "matedialog", "qarma")
"""That imgui-bundle's dialogs are shown by, but on Windows and macOS."""


def has_dialogs(dialogs: Any) -> bool:
    """Whether the desktop can show one; imgui-bundle 1.93 has no `settings` to ask any more."""
    settings = getattr(dialogs, "settings", None)
    if settings is not None:
        return bool(settings.available())
    return sys.platform in ("win32", "darwin") or any(map(shutil.which, _PROGRAMS))


class Asking:
    """`ask` opens the dialog; `watch` gives what was chosen in it to `opened`."""

    def __init__(self, dialogs: Any, opened: Callable[[str], None]) -> None:
        self._dialogs, self._opened = dialogs, opened
        self._dialog: Any = None

    @classmethod
    def where_there_is_one(cls, opened: Callable[[str], None]) -> Asking | None:
        """None where the desktop has no dialogs, or imgui-bundle is not installed."""
        try:
            from imgui_bundle import portable_file_dialogs as dialogs
        except ImportError:
            return None
        return cls(dialogs, opened) if has_dialogs(dialogs) else None

    def ask(self) -> None:
        """Open the dialog, unless it is open."""
        if self._dialog is None:
            endings = " ".join(f"*{suffix}" for suffix in (*SCENE_SUFFIXES, *MAP_SUFFIXES))
            filters = ["scenes, models, environments", endings, "all files", "*"]
            self._dialog = self._dialogs.open_file("Open", "", filters)

    def taken(self) -> bool:
        """Open what was chosen since the last call; true where something was."""
        if self._dialog is None or not self._dialog.ready(0):
            return False
        # The dialog is over, whether or not something was chosen.
        names, self._dialog = self._dialog.result(), None
        for name in names[:1]:
            self._opened(name)
        return bool(names)

    async def watch(self, sleep: Callable[[float], Any], view: CanvasView) -> None:
        """Look now and then whether something was chosen, until the window is closed."""
        while not view.canvas.get_closed():
            await sleep(_LOOK_S)
            if self.taken():
                view.touched()
