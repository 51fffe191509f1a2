"""Pipelines cached by what they are made of, so that a second renderer compiles nothing again."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

MOST_KEPT = 1024
"""A scene's passes are about a hundred; a session that tries many lattices makes more."""


class Pipelines:
    """The pipelines of one device; the least recently used are dropped first."""

    def __init__(self, most: int = MOST_KEPT) -> None:
        self._most = most
        self._changing = threading.Lock()
        self._kept: OrderedDict[tuple[str, ...], Any] = OrderedDict()

    def get(self, text: str, parts: Any, make: Callable[[], Any]) -> Any:
        """The pipeline of the WGSL `text` and of `parts`, created by `make` where it is not cached.

        `parts`: whatever else it is made of, compared by its repr. Two threads may create the same
        one at once; either serves.
        """
        key = (text, repr(parts))
        with self._changing:
            found = self._kept.get(key)
        if found is None:
            found = make()
        with self._changing:
            self._kept[key] = found
            self._kept.move_to_end(key)
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)
        return found

    def __len__(self) -> int:
        return len(self._kept)
