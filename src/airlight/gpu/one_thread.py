"""A guard for what one thread at a time may use."""

from __future__ import annotations

import threading
from types import TracebackType

from ..errors import DeviceError

THREADS_REMEDY = "Make a Renderer for each thread, or a lock around the one that they share"


class OneThread:
    """A context for one thread at a time, which may enter it more than once.

    A thread that comes while another is inside gets a DeviceError: waiting would hide that the two
    change each other's drawing.
    """

    def __init__(self, what: str) -> None:
        self._what, self._held = what, threading.RLock()

    def __enter__(self) -> None:
        if not self._held.acquire(blocking=False):
            raise DeviceError(f"{self._what} is used by two threads at once", remedy=THREADS_REMEDY)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._held.release()
