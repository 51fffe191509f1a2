"""What one thread at a time may use, and what says so to a second one."""

from __future__ import annotations

import threading
from types import TracebackType

from ..errors import DeviceError

THREADS_REMEDY = "Make a Renderer for each thread, or a lock around the one that they share"


class OneThread:
    """A context that only one thread at a time may be in; it may be in it more than once.

    Raises DeviceError in a thread that comes while another is in it: to wait would hide that the
    two change what the other draws.
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
