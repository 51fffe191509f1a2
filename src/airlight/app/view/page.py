"""The panel in a page: what is declared goes there as JSON, what a hand does comes back.

A browser's page and a notebook's cell show the same `web/panel.js`; each brings its own way to
`send` messages.
"""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ...maths.arrays import U8
from .gizmos import Mark
from .help import HELP
from .save import Saver
from .sections import sections
from .session import Session
from .uploads import Uploads
from .widgets import plain, told

Message = Mapping[str, Any]
WEB = Path(__file__).with_name("web")
_SHOWN = "panel.shown"
_MOST_PX, _MOST_RATIO = 4096.0, 8.0


class Page:
    """A front for `CanvasView`: `heard` messages of the page, `render` tells it what is new.

    `touched` is called after each message that changed something.
    """

    def __init__(self, session: Session, send: Callable[[Message], None]) -> None:
        self.session, self._send = session, send
        self.saver = Saver(session, Path.cwd(), self._copied)
        self.is_shown, self.shows_help = False, False
        self.marks: tuple[Mark, ...] = ()
        self.touched: Callable[[], None] = lambda: None
        self.uploads = Uploads(lambda name: session.drop(name, stays=False))
        self._told: dict[str, str] = {}
        self._charts: dict[int, tuple[U8, str]] = {}

    def width(self, whole: float, height: float) -> float:
        """Nothing: the page gives the image the rest."""
        del whole, height
        return 0.0

    def covers(self, x: float, y: float) -> bool:
        """Never: what is on the panel does not reach the image."""
        del x, y
        return False

    def takes_text(self) -> bool:
        """Never: the page's fields have their own keys."""
        return False

    def render(self) -> None:
        """Tell the page what has changed since it was told last."""
        # Each part goes out only where it differs from what the page has.
        self._tell("status", self._status())
        # The panel's sections with their widgets, as JSON.
        listed = [
            {
                "name": section.name,
                "open": section.is_open,
                "widgets": [plain(widget, self._address) for widget in section.widgets],
            }
            for section in sections(self.session, self.saver)
        ]
        self._tell("panel", {"sections": listed})
        # Gizmos over the image.
        marks = [asdict(mark) for mark in self.marks]
        self._tell("marks", {"marks": marks})

    def heard(self, message: Any) -> bool:
        """Take a page's message, unless it is wrong; false where it is none of the panel's."""
        kind = message.get("type") if isinstance(message, dict) else None
        # Messages of the panel by their type; others may be the canvas's.
        does = {
            "hello": self._hello,
            "set": self._set,
            "pinch": self._pinch,
            "file": self.uploads.take,
        }.get(kind if isinstance(kind, str) else "")
        if does is None:
            return False
        does(message)
        self.touched()
        return True

    def _hello(self, message: Message) -> None:
        """A page was opened: it knows nothing, and says whether it has room for the panel."""
        self._told.clear()
        self.is_shown = message.get("shown") is True

    def _set(self, message: Message) -> None:
        key, value = message.get("key"), message.get("value")
        # Whether the panel is shown is the page's own; all else changes a widget.
        if key == _SHOWN and isinstance(value, bool):
            self.is_shown = value
        elif isinstance(key, str):
            told(sections(self.session, self.saver), key, value)

    def _pinch(self, message: Message) -> None:
        """Two fingers went along and apart."""
        # Numbers within reason, or the message is dropped.
        numbers = [message.get(name) for name in ("dx", "dy", "scale")]
        if not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in numbers):
            return
        dx, dy, scale = (float(v) for v in numbers if v is not None)
        if abs(dx) <= _MOST_PX and abs(dy) <= _MOST_PX and 1 / _MOST_RATIO <= scale <= _MOST_RATIO:
            self.session.controls.pinch(dx, dy, scale)

    def _status(self) -> dict[str, Any]:
        session, state = self.session, self.session.state
        return {
            "title": state.scene.name,
            "shown": self.is_shown,
            "help": HELP if self.shows_help else None,
            "message": state.message,
            "doubts": list(session.doubts),
            "notice": f"{state.notice}   {session.progress}".strip(),
            "share": session.share if session.renderer else 0.0,
            "text": session.status,
        }

    def _tell(self, kind: str, what: Message) -> None:
        message = {"type": kind, **what}
        text = json.dumps(message)
        if self._told.get(kind) != text:
            self._told[kind] = text
            self._send(message)

    def _copied(self, text: str) -> None:
        self._send({"type": "copy", "text": text})

    def _address(self, image: U8) -> str:
        """A chart as an address of data; made once for each image."""
        known = self._charts.get(id(image))
        # A few charts are remembered, of which the oldest goes.
        if known is None or known[0] is not image:
            from PIL import Image as Pillow

            out = io.BytesIO()
            Pillow.fromarray(image).save(out, "PNG")
            known = (image, f"data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}")
            self._charts = {id(image): known, **dict(list(self._charts.items())[:7])}
        return known[1]


def web_text(name: str) -> str:
    """A file of `web/`."""
    return (WEB / name).read_text(encoding="utf-8")
