"""A session on a canvas: a window, a browser's image, a notebook's, or none at all."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import time
from collections.abc import Callable, Iterator
from typing import Any, Protocol

from ...display.show import Place
from ...errors import AirlightError
from ...gpu.canvas import CanvasSurface, imgui_overlay
from .gizmos import Colour, Mark
from .projection import Projection
from .save import Saver
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
_POINTER = ("pointer_down", "pointer_up", "pointer_move")


class Front(Protocol):
    """What shows the panel: imgui on the window's surface, or a page beside the image."""

    is_shown: bool
    shows_help: bool
    marks: tuple[Mark, ...]

    def width(self, whole: float, height: float) -> float:
        """How much of the surface's width, in logical pixels, is not the image's."""

    def covers(self, x: float, y: float) -> bool:
        """Whether a click here, in logical pixels, is the panel's."""

    def takes_text(self) -> bool:
        """Whether keys are being typed into one of its fields."""

    def render(self) -> None:
        """Draw, or tell the page, what stands in it now."""


class CanvasView:
    """Draws when something changed, and goes on until the image is refined."""

    def __init__(
        self, canvas: Any, session: Session, saver: Saver, front: Front | None = None
    ) -> None:
        self.canvas, self.session, self.saver = canvas, session, saver
        self.surface = CanvasSurface(session.gpu, canvas)
        session.attach(self.surface.format)
        # Before imgui, which decides by the last frame: on a slow machine, too long ago.
        canvas.add_event_handler(self.on_event, *EVENTS, order=-100)
        self.panel = front or self._imgui()
        self._owed, self._cursor = 0, "default"
        canvas.request_draw(self.draw)

    def _imgui(self) -> Front | None:
        try:
            overlay = imgui_overlay(self.session.gpu, self.canvas)
            from .gui import Panel
        except ImportError:
            self.session.state.notice = "no panel: imgui-bundle is not installed"
            return None
        return Panel(self.session, self.saver, overlay)

    @property
    def _ratio(self) -> float:
        return float(self.canvas.get_pixel_ratio())

    def image_place(self) -> Place:
        """Where on the surface the image is, pixels."""
        # The panel takes a strip at the left; the rest of the surface is the image's.
        width, height = self.surface.size
        logical = (width / self._ratio, height / self._ratio)
        left = round(self.panel.width(*logical) * self._ratio) if self.panel else 0
        return Place((left, 0), (width - left, height))

    def seen(self) -> Projection:
        """The camera onto the image, in logical pixels."""
        width, height = self.image_place().extent
        size = (max(width / self._ratio, 1.0), max(height / self._ratio, 1.0))
        return Projection(self.session.controls.camera, size)

    def draw(self) -> None:
        """One frame. A window folded to nothing is not drawn."""
        if min(self.surface.size) < 1:
            return
        # The image fills what the panel leaves, no larger than the device's textures may be.
        place = self.image_place()
        size = (min(int(place.extent[0]), _LARGEST_SIDE_PX), int(place.extent[1]))
        size = (size[0], min(size[1], _LARGEST_SIDE_PX))
        wants_more = self.session.frame(self.surface.view(), size, time.monotonic(), place)
        # Handles and the panel lie over the image that was just drawn.
        if self.panel:
            grips = self.session.grips
            grips.is_shown = self.panel.is_shown and self.session.renderer is not None
            self.panel.marks = (*grips.marks(self.seen()), *self._divider())
            self.panel.render()
        # Refinement and frames that are owed to events ask for the next one; else nothing is
        # drawn.
        self._owed = max(0, self._owed - 1)
        if wants_more or self._owed:
            self.canvas.request_draw()

    def _divider(self) -> Iterator[Mark]:
        """Where two images are beside each other, whose they are."""
        session = self.session
        if session.is_divided:
            left, right = session.compared_names
            yield from divider_marks(session.state.split, left, right, self.seen())

    def _point(self, event: dict[str, Any]) -> None:
        """Show by the pointer that a press takes the line between two images."""
        seen = self.seen()
        x = self._within(event)["x"]
        is_image = self.panel is None or not self.panel.covers(event["x"], event["y"])
        cursor = "default"
        if is_image and self.session.grips.over_line(seen, x):
            cursor = "ew-resize"
        if cursor != self._cursor:
            self._cursor = cursor
            self.canvas.set_cursor(cursor)

    def on_event(self, event: dict[str, Any]) -> None:
        """Keys of the viewer, lights that the mouse drags, and the camera's mouse and keys."""
        kind = event["event_type"]
        # The panel first, then a light in the hand; what neither takes is the camera's.
        if not self._is_panels(event):
            if kind == "key_down":
                self._key(event["key"], event.get("modifiers", ()))
            elif kind == "char":
                self._typed(event.get("data"))
            if not (
                kind in _POINTER and self.session.grips.handle(self._within(event), self.seen())
            ):
                self.session.controls.handle(event)
        if kind == "pointer_move":
            self._point(event)
        self.touched()

    def touched(self) -> None:
        """A hand did something: the next images are wanted."""
        self.session.touch(time.monotonic())
        self._owed = _FRAMES_PER_EVENT
        self.canvas.request_draw()

    def _within(self, event: dict[str, Any]) -> dict[str, Any]:
        """A pointer's event with its place in the image."""
        return {**event, "x": event["x"] - self.image_place().corner[0] / self._ratio}

    def _key(self, key: str, modifiers: tuple[str, ...]) -> None:
        session, panel = self.session, self.panel
        # Keys of the panel, then of the view, then undo and redo.
        if key == "Tab" and panel:
            panel.is_shown = not panel.is_shown
        elif key == "Escape":
            session.state.picked = -1
        elif key == "r":
            session.controls.reset()
        elif key == "f":
            session.controls.is_flying = not session.controls.is_flying
        elif key.lower() in ("z", "y") and {"Control", "Meta"} & set(modifiers):
            is_again = key.lower() == "y" or "Shift" in modifiers
            (session.redo if is_again else session.undo)()

    def _typed(self, text: Any) -> None:
        """Characters that need other keys on other keyboards: a window names keys as in the US."""
        if text == "?" and self.panel:
            self.panel.shows_help = not self.panel.shows_help

    def _is_panels(self, event: dict[str, Any]) -> bool:
        """Whether a press, a turn of the wheel or a key is the panel's; a drag goes on over it."""
        if self.panel is None:
            return False
        # Only a press begins something; a drag that began on the image goes on over the panel.
        if event["event_type"] in ("pointer_down", "wheel"):
            return self.panel.covers(event["x"], event["y"])
        return event["event_type"] in ("key_down", "char") and self.panel.takes_text()

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


_PALE: Colour = (0.94, 0.94, 0.94)
_TEXT_PX, _TOP_PX, _BESIDE_PX, _GRIP_PX = 13.0, 26.0, 12.0, 6.0


def divider_marks(split: float, left: str, right: str, seen: Projection) -> Iterator[Mark]:
    """A grip on the line at a `split` of the width, and beside it the names of both images."""
    width, height = seen.size
    x = round(split * width, 1)
    yield Mark("dot", ((x, round(height / 2.0, 1)),), _PALE, _GRIP_PX)
    for name, side in (left, -1.0), (right, 1.0):
        at = (x + side * _BESIDE_PX, _TOP_PX)
        yield Mark("text", (at,), _PALE, _TEXT_PX, name, ends_here=side < 0.0)
