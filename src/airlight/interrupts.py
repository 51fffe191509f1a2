"""Ctrl-C from the command's first moment to its last: quiet, exit code 130.

Before a command begins and after it has ended, Ctrl-C ends the process at once. In between it is
a KeyboardInterrupt, also where a library turns that into another error or loses it.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

# A shell's number for what Ctrl-C ended: 128 + SIGINT.
INTERRUPTED = 130
_AGAIN_S = 0.05


def leave_quietly() -> None:
    """From now on Ctrl-C ends the process at once; nothing changes where it is ignored."""
    # A program that takes or ignores the signal itself goes on doing so.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)


@contextmanager
def taken_up() -> Iterator[None]:
    """In the block Ctrl-C is a KeyboardInterrupt, which is what leaves the block then.

    Only where `leave_quietly` was called: a program that uses the package has its own ways.
    """
    if signal.getsignal(signal.SIGINT) is not _leave:
        yield
        return
    # Interrupts are noted, because an error may hide them.
    seen: list[int] = []

    def interrupt(number: int, frame: FrameType | None) -> NoReturn:
        seen.append(number)
        raise KeyboardInterrupt

    # What cannot be raised where it happens is raised again.
    before, sys.unraisablehook = sys.unraisablehook, _unraisable
    signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    except KeyboardInterrupt:
        raise
    except Exception:
        # An import that is interrupted may say that the module is broken.
        if seen:
            raise KeyboardInterrupt from None
        raise
    finally:
        signal.signal(signal.SIGINT, _leave)
        sys.unraisablehook = before


def _leave(number: int, frame: FrameType | None) -> NoReturn:
    os._exit(INTERRUPTED)


def _interrupt_main() -> None:
    """The signal once more, for the main thread, which it wakes where the system can do that."""
    # A signal to the thread itself ends its waiting.
    ident = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and ident is not None:
        signal.pthread_kill(ident, signal.SIGINT)
    else:
        _thread.interrupt_main()


def _unraisable(lost: sys.UnraisableHookArgs) -> None:
    """Raise an interrupt again that came where nothing can be raised, as in a callback from C."""
    if issubclass(lost.exc_type, KeyboardInterrupt):
        # Not at once: what is raised in here is lost, too.
        threading.Timer(_AGAIN_S, _interrupt_main).start()
    else:
        sys.__unraisablehook__(lost)
