"""The one process that may use the graphics driver: a fork of it lacks the driver's threads.

Whatever a forked child asks of the driver waits for ever, its exit included.
"""

from __future__ import annotations

import ctypes
import os

from wgpu.backends.wgpu_native import _api

from ..errors import DeviceError

FORK_REMEDY = 'Start such processes afresh: multiprocessing.get_context("spawn")'
_user: int | None = None  # the process that uses the driver, by its number


def enter_driver() -> None:
    """Note that this process uses the driver; call it before the driver.

    Raises DeviceError in a child that was forked after the first call. Parents that never called it
    may be forked.
    """
    global _user
    if _user is None:
        _user = os.getpid()
    elif is_forked():
        raise DeviceError(
            "this process was forked from one that had used the graphics driver, "
            "and a fork has none of its threads",
            remedy=FORK_REMEDY,
        )


def is_forked() -> bool:
    """Whether this process has devices of its parent's, which it can neither use nor release."""
    return _user is not None and _user != os.getpid()


def _leave_driver() -> None:
    """In a forked child: forget the parent's devices without telling the driver."""
    if _user is None:
        return
    _api.libf = None  # wgpu-py then releases nothing when objects go
    try:
        # The driver's and LLVM's own farewells, which come with exit(), join threads.
        c = ctypes.CDLL(None)
        c.on_exit(c._exit, None)
    except (OSError, AttributeError):  # a C library without on_exit
        return


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_leave_driver)
