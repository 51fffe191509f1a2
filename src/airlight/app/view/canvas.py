"""A session on a canvas: a window, a browser's image, a notebook's, or none at all."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ...errors import AirlightError
from ...gpu.canvas import CanvasSurface, imgui_overlay
from .save import Copy, Saver
from .session import Session

EVENTS = (
    "pointer_down",
    "pointer_up",
    "pointer_move",
    "wheel",
    "key_down",
    "key_up",
    "resize",
    "pointer_enter",
    "pointer_leave",
    "char",
)
NOT_INSTALLED = "Install it with: pip install 'airlight[view]'"
_LARGEST_SIDE_PX = 8192
_NEWS_S = 0.1
_FRAMES_PER_EVENT = 4  # imgui takes a click in over several: moved there, pressed, let go, shown


class CanvasView:
    """Draws when something changed, and goes on until the image is refined."""

    def __init__(
        self,
        canvas: Any,
        session: Session,
        *,
        folder: Path | None = None,
        copy: Copy | None = None,
    ) -> None:
        self.canvas, self.session = canvas, session
        self.surface = CanvasSurface(session.gpu, canvas)
        session.attach(self.surface.format)
        self.saver = Saver(session, folder or Path.cwd(), copy)
        self.overlay: Any = None
        self.panel: Any = None
        self._owed = 0
        self._make_panel()
        # Before the overlay, which decides by the last frame: on a slow machine, too long ago.
        canvas.add_event_handler(self.on_event, *EVENTS, order=-100)
        canvas.request_draw(self.draw)

    def _make_panel(self) -> None:
        try:
            self.overlay = imgui_overlay(self.session.gpu, self.canvas)
            from .gui import Panel
        except ImportError:
            self.session.state.notice = "no panel: imgui-bundle is not installed"
            return
        self.panel = Panel(self.session, self.saver)
        self.overlay.set_gui(self.panel.draw)

    def draw(self) -> None:
        """One frame. A window folded to nothing is not drawn."""
        width, height = self.surface.size
        if width < 1 or height < 1:
            return
        size = (min(width, _LARGEST_SIDE_PX), min(height, _LARGEST_SIDE_PX))
        wants_more = self.session.frame(self.surface.view(), size, time.monotonic())
        if self.overlay:
            self.overlay.render()
        self._owed = max(0, self._owed - 1)
        if wants_more or self._owed:
            self.canvas.request_draw()

    def on_event(self, event: dict[str, Any]) -> None:
        """Keys of the viewer, and the camera's share of mouse and keys."""
        if not self._is_panels(event):
            if event["event_type"] == "key_down":
                self._key(event["key"])
            self.session.controls.handle(event)
        self.session.touch(time.monotonic())
        self._owed = _FRAMES_PER_EVENT
        self.canvas.request_draw()

    def _key(self, key: str) -> None:
        if key == "Tab" and self.panel:
            self.panel.is_shown = not self.panel.is_shown
        elif key == "?" and self.panel:
            self.panel.shows_help = not self.panel.shows_help
        elif key == "r":
            self.session.controls.reset()
        elif key == "f":
            self.session.controls.is_flying = not self.session.controls.is_flying

    def _is_panels(self, event: dict[str, Any]) -> bool:
        """Whether a press, a turn of the wheel or a key is the panel's; a drag goes on over it."""
        if self.panel is None:
            return False
        if event["event_type"] in ("pointer_down", "wheel"):
            return bool(self.panel.covers(event["x"], event["y"]))
        return event["event_type"] == "key_down" and bool(self.overlay.backend.io.want_text_input)

    async def watch(self, sleep: Callable[[float], Any]) -> None:
        """Draw again after every edit of the scene file, and when what was made between frames is
        there.
        """
        while not self.canvas.get_closed():
            await sleep(_NEWS_S)
            if self.session.has_edit() or self.session.has_news():
                self.canvas.request_draw()


async def close_on_signals(canvas: Any) -> None:
    """From now on Ctrl-C and a polite kill close the canvas between two frames.

    rendercanvas's own handler closes it at once, even in the middle of a frame, whose texture is
    then gone when it is submitted: wgpu aborts the process over that.
    """
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        with contextlib.suppress(NotImplementedError):  # Windows
            loop.add_signal_handler(number, canvas.close)


def missing(what: str) -> AirlightError:
    """For a part of the extra `view` that is not installed."""
    return AirlightError(f"the viewer needs {what}, which is not installed", remedy=NOT_INSTALLED)
