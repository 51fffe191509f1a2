"""Long work of the viewer: in a thread of its own, one pass of the device at a time.

The viewer's frames come first. `Turns` says who may use the device; `Task` is one such piece of
work, which the viewer polls at every frame.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Generic, TypeVar

from ...errors import AirlightError
from ...gpu.device import Gpu
from ...gpu.sliced import SlicedCommands

T = TypeVar("T")
_LOOK_S = 0.05  # how often paused work looks whether it may go on


class Stopped(BaseException):
    """Raised inside a task that was told to stop, because nobody needs its result."""


class Turns:
    """One thread at a time on the device, the viewer's own before all others."""

    def __init__(self) -> None:
        self._device = threading.RLock()
        self._free = threading.Event()
        self._free.set()
        self._depth = 0
        self._behind = 0  # the thread that works behind the viewer's back, while it has its turn

    @contextmanager
    def frame(self) -> Iterator[None]:
        """The viewer's own turn: a frame, or a part of one; in its thread only."""
        # Background work is held back as soon as a frame is wanted, before the device is free.
        self._depth += 1
        self._free.clear()
        try:
            with self._device:
                yield
        finally:
            self._depth -= 1
            if not self._depth:
                self._free.set()

    @contextmanager
    def behind(self) -> Iterator[None]:
        """A turn for background work, while no frame is being drawn."""
        # A task's own nested passes are in its turn already.
        if self.is_behind_here:
            yield
            return
        self._free.wait()
        with self._device:
            self._behind = threading.get_ident()
            try:
                yield
            finally:
                self._behind = 0

    @property
    def is_behind_here(self) -> bool:
        """Whether this thread has such a turn now."""
        return self._behind == threading.get_ident()


class Task(Generic[T]):
    """`work(commands)` in a thread of its own. While it is paused it holds before its next pass."""

    def __init__(self, gpu: Gpu, turns: Turns, work: Callable[[SlicedCommands], T]) -> None:
        self._turns, self._work = turns, work
        self._commands = SlicedCommands(gpu, self._turn)
        self._begun_s = time.monotonic()
        self._may_go_on, self._is_stopped = threading.Event(), False
        self._may_go_on.set()
        self._result: T | None = None
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, name="airlight viewer")
        self._thread.start()

    @property
    def is_done(self) -> bool:
        """Whether it ended, well or not."""
        return not self._thread.is_alive()

    @property
    def progress(self) -> str:
        """For how long it has been at work, and what its passes do now, as `--stats` names it."""
        # Between stages shaders are compiled and arrays uploaded.
        stage = self._commands.stage_name
        doing = "meshes and shaders" if stage == "other" else stage
        return f"{time.monotonic() - self._begun_s:.0f} s: {doing}"

    def pause(self, *, holds: bool) -> None:
        """Hold before the next pass, or go on."""
        if holds:
            self._may_go_on.clear()
        else:
            self._may_go_on.set()

    def stop(self) -> None:
        """Make it end before its next pass, by raising `Stopped` in it. Does not wait for that."""
        self._is_stopped = True
        self._may_go_on.set()

    def wait(self) -> None:
        """Return once it ended."""
        self._may_go_on.set()
        self._thread.join()

    def result(self) -> T | None:
        """What the work returned, None where it was stopped. Raises what it raised."""
        self._thread.join()
        if self._error is not None:
            raise self._error
        return self._result

    def check(self) -> None:
        """For the work itself, where it could end: raises `Stopped` when it should, and pauses."""
        # Paused work looks now and then whether it was told to stop.
        while not (self._may_go_on.wait(_LOOK_S) or self._is_stopped):
            pass
        if self._is_stopped:
            raise Stopped

    @contextmanager
    def _turn(self) -> Iterator[None]:
        if not self._turns.is_behind_here:  # who holds the device must not wait for the viewer
            self.check()
        with self._turns.behind():
            yield

    def _run(self) -> None:
        try:
            # What ends the work is stored, and raised where its result is asked for.
            self._result = self._work(self._commands)
        except Stopped:
            pass
        except AirlightError as error:
            self._error = error
        except Exception as error:  # a driver's refusal must not take the window down
            self._error = error


def said(error: BaseException) -> str:
    """The text that the panel shows about a task's error."""
    if isinstance(error, AirlightError):
        return str(error)
    text = " ".join(str(error).split())[:400]
    return f"internal error: {type(error).__name__}: {text}"
