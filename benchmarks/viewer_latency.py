"""How soon the viewer answers a drag: `python benchmarks/viewer_latency.py SCENE [--size WxH]`

Opens SCENE in the viewer on an offscreen canvas and drags through the image with real pointer
events, 60 a second for half a second, after each of some rests: while renderers are being made,
while the image is refined, once it is done. Prints, for each drag, the time from an event to the
end of the frame that shows it, milliseconds: of the first event, the median, the longest.
"""

from __future__ import annotations

import argparse
import threading
import time
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
from rendercanvas import offscreen

from airlight.app.view.canvas import CanvasView
from airlight.app.view.save import Saver
from airlight.app.view.session import Session
from airlight.scene.io import load

RESTS_S = (8, 1, 1, 1, 1, 1, 2, 3, 8, 20)
MOVES = 30
_EVENT_S = 1 / 60
_NEWS_S = 0.1


class Hand(threading.Thread):
    """Puts events into `events`, each with the time at which it happened."""

    def __init__(self, size: tuple[int, int], rests_s: list[float], session: Session) -> None:
        super().__init__(daemon=True)
        self.events: deque[tuple[float, int, dict[str, Any]]] = deque()
        self.doing: list[str] = []
        self._size, self._rests_s, self._session = size, rests_s, session

    def run(self) -> None:
        """Rest and drag."""
        x, y = self._size[0] / 2, self._size[1] / 2
        for drag, rest_s in enumerate(self._rests_s):
            time.sleep(rest_s)
            self.doing.append(doing(self._session))
            self._put(drag, "pointer_down", x=x, y=y, button=1)
            for move in range(MOVES):
                self._put(drag, "pointer_move", x=x + 2 * move + 2, y=y, buttons=(1,))
                time.sleep(_EVENT_S)
            self._put(drag, "pointer_up", x=x + 2 * MOVES, y=y, button=1)
        time.sleep(1.0)

    def _put(self, drag: int, kind: str, **fields: Any) -> None:
        event = {"event_type": kind, "modifiers": (), "buttons": (), **fields}
        self.events.append((time.monotonic(), drag, event))


def doing(session: Session) -> str:
    """What goes on in the background."""
    if session.progress:
        return f"making: {session.progress}"
    if session.fine.is_working:
        return f"refining: {session.fine.samples} samples"
    return "at rest" if session.quality.is_done else "samples at rest"


def measured(scene: str, size: tuple[int, int], rests_s: list[float]) -> None:
    """Print the time of each drag."""
    canvas = offscreen.RenderCanvas(size=size)
    session = Session(load(scene), source=scene)
    view = CanvasView(canvas, session, Saver(session, Path()))
    if view.panel:
        view.panel.is_shown = False
    wanted = threading.Event()
    wanted.set()
    canvas.request_draw = lambda draw=None: wanted.set()  # the loop is here
    hand, waits_ms = Hand(size, rests_s, session), [list[float]() for _ in rests_s]
    hand.start()
    news_s = 0.0
    while hand.is_alive():
        # As a window's loop has it: events, then a frame, where one is wanted.
        came = [hand.events.popleft() for _ in range(len(hand.events))]
        for _, _, event in came:
            canvas.submit_event(event)
        if came:
            canvas._events.flush()
        if time.monotonic() > news_s and session.has_news():
            wanted.set()
            news_s = time.monotonic() + _NEWS_S
        if not wanted.is_set():
            time.sleep(0.001)
            continue
        wanted.clear()
        canvas.draw()
        now = time.monotonic()
        for then, drag, event in came:
            if event["event_type"] == "pointer_move":
                waits_ms[drag].append(1e3 * (now - then))
    for rest_s, what, ms in zip(rests_s, hand.doing, waits_ms, strict=True):
        line = f"first {ms[0]:4.0f}  median {np.median(ms):4.0f}  longest {max(ms):4.0f} ms"
        print(f"{line}  after {rest_s} s, {what}")
    session.close()


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--rests", help="seconds before each drag, by commas")
    given = parser.parse_args()
    rests_s = [float(s) for s in given.rests.split(",")] if given.rests else list(RESTS_S)
    width, height = (int(side) for side in given.size.split("x"))
    measured(given.scene, (width, height), rests_s)


if __name__ == "__main__":
    main()
