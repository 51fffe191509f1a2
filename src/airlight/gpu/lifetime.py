"""From opening a device to closing it: one thread at a time, and whole again after an error."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from types import TracebackType
from typing import Self

from ..errors import DeviceError
from .device import Gpu
from .process import enter_driver, is_forked

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


class Made:
    """What was made, until its owner and all to whom it was lent have given it back; any thread."""

    def __init__(self, made: ExitStack) -> None:
        self._made, self._users, self._lock = made, 1, threading.Lock()

    def lend(self) -> None:
        """One user more."""
        with self._lock:
            self._users += 1

    def give_back(self) -> None:
        """One user less; the last one releases it."""
        with self._lock:
            self._users -= 1
            is_last = self._users == 0
        if is_last:
            self._made.close()


class DeviceLifetime(ABC):
    """What holds a device and all that is made on it; a context that closes it at its end.

    A derived class says how both are made, and calls `_make` once it is ready. `_is_torn`: work on
    the device was interrupted, so `used` recreates everything.
    """

    gpu: Gpu

    def __init__(self, what: str) -> None:
        """`what` it is, for messages: "this Renderer"."""
        self._what, self._one_thread = what, OneThread(what)
        self._is_closed, self._is_torn = False, True
        self._made = Made(ExitStack())

    @abstractmethod
    def _open(self) -> Gpu:
        """The device, as a scope of its own."""

    @abstractmethod
    def _create(self, made: ExitStack) -> None:
        """Create all that is on the device; `made` takes what else there is to release."""

    def _make(self) -> None:
        self._is_torn = True
        self.gpu = gpu = self._open()
        # What is made half when an error comes is given back with the stack.
        with gpu.guarded(), ExitStack() as made:
            made.callback(gpu.release)
            self._create(made)
            self._made = Made(made.pop_all())
        self._is_torn = False

    def _remake(self) -> None:
        before, self._made = self._made, Made(ExitStack())
        before.give_back()
        self._make()

    def _lend(self) -> Callable[[], None]:
        """What is made on the device stays until the returned function is called, too."""
        self._check_open()
        made = self._made
        made.lend()
        return made.give_back

    @contextmanager
    def used(self) -> Iterator[None]:
        """A context in which this thread alone uses the device.

        It recreates the resources that an interrupted frame left undefined. Methods that draw
        enter it themselves.

        Raises DeviceError: another thread is in it, this process was forked, the device was closed,
        was lost or has no memory left.
        """
        enter_driver()
        with self._one_thread:
            self._check_open()
            if self._is_torn:
                self._remake()
            with self.gpu.guarded():
                yield

    def close(self) -> None:
        """Give the device's memory back; a second call does nothing.

        Raises DeviceError while another thread uses it.
        """
        if is_forked():  # the memory is the parent's
            self._is_closed = True
        if self._is_closed:
            return
        with self._one_thread:
            self._is_closed = True
            self._made.give_back()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _check_open(self) -> None:
        if self._is_closed:
            raise DeviceError(f"{self._what} is closed", remedy="Make a new one")
