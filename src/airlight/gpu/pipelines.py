"""Pipelines cached by what they are made of, so that a second renderer compiles nothing again.

A kernel that takes a driver seconds is begun in a thread of its own where it is known to be needed,
while the host goes on with the scene.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

MOST_KEPT = 1024
"""A scene's passes are about a hundred; a session that tries many lattices makes more."""


class Pipelines:
    """The pipelines of one device; the least recently used are dropped first."""

    def __init__(self, most: int = MOST_KEPT) -> None:
        self._most = most
        self._changing = threading.Lock()
        self._kept: OrderedDict[tuple[str, ...], Any] = OrderedDict()
        self._begun: dict[tuple[str, ...], Future[Any]] = {}

    def get(self, text: str, parts: Any, make: Callable[[], Any]) -> Any:
        """The pipeline of the WGSL `text` and of `parts`, created by `make` where it is not cached.

        `parts`: whatever else it is made of, compared by its repr. Two threads may create the same
        one at once; either serves.
        """
        key = (text, repr(parts))
        with self._changing:
            found = self._kept.get(key)
            begun = self._begun.get(key)
        # Made outside the lock: compiling takes seconds, and other threads go on.
        try:
            if found is None:
                found = make() if begun is None else begun.result()
        finally:
            with self._changing:
                self._begun.pop(key, None)

        # Whichever was used last stays longest.
        with self._changing:
            self._kept[key] = found
            self._kept.move_to_end(key)
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)
        return found

    def begin(self, text: str, parts: Any, make: Callable[[], Any]) -> None:
        """Start what `get` of the same will ask for, in another thread, where nobody did yet.

        What goes wrong there is raised by `get`.
        """
        key, begun = (text, repr(parts)), Future[Any]()

        def run() -> None:
            try:
                begun.set_result(make())
            except BaseException as error:
                begun.set_exception(error)

        # Not a daemon: a process that ended within a driver would end badly.
        thread = threading.Thread(target=run, name="airlight compiles")
        try:
            with self._changing:
                if key in self._kept or key in self._begun:
                    return
                self._begun[key] = begun
            thread.start()
        except BaseException:
            # Nobody may wait for what an interrupt kept from starting.
            with self._changing:
                if self._begun.get(key) is begun:
                    del self._begun[key]
            raise

    def __len__(self) -> int:
        return len(self._kept)
