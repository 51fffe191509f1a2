"""Lost devices and exhausted memory as DeviceError; the one place that knows wgpu's messages."""

from __future__ import annotations

import logging
import os
import re
from mmap import mmap
from types import TracebackType
from typing import TYPE_CHECKING

import wgpu

from ..errors import AirlightError, DeviceError
from .process import enter_driver

if TYPE_CHECKING:
    from .device import Gpu

MEMORY_REMEDY = (
    "Lower the image's size or the technique's resolution, or close other Renderers and programs"
)
LOST_REMEDY = "Make a new Renderer; if it is lost again, take another adapter ('cpu' needs no GPU)"
OPEN_REMEDY = "Close what else uses the device or the memory, or choose another adapter (--adapter)"
TO_FIND, TO_OPEN = 512 << 20, 128 << 20
"""Bytes of addresses that drivers may want for themselves: with less, Mesa's end the process."""
_NO_MEMORY = re.compile(r"not enough memory|out of memory|OutOfMemory", re.IGNORECASE)
_LABEL = re.compile(r"label = '([^']*)'")
_LOGGED = ("DEVICE LOST!", "The WGPU device was lost")  # by wgpu-py, beside our own message


class Guarded:
    """A context that turns what the device of `gpu` refuses into DeviceError.

    It raises one, too, in a process that was forked from the device's.
    """

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu

    def __enter__(self) -> None:
        enter_driver()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        # airlight's own errors say all already; others are told apart by what they mean.
        if isinstance(error, Exception) and not isinstance(error, AirlightError):
            refusal = refused(self._gpu, error)
            if refusal is not None:
                raise refusal from error


def refused(gpu: Gpu, error: Exception) -> DeviceError | None:
    """The DeviceError that `error` stands for; None where it is about something else."""
    # Drivers report exhaustion by several types and texts; a person needs one sentence and a
    # remedy.
    if isinstance(error, MemoryError):
        return DeviceError(f"no memory is left: {error or 'of any size'}", remedy=MEMORY_REMEDY)
    is_memory = isinstance(error, (wgpu.GPUError, RuntimeError)) and _NO_MEMORY.search(str(error))
    if is_memory or isinstance(error, wgpu.GPUOutOfMemoryError):
        label = _LABEL.search(str(error))
        what = f" for '{label[1]}'" if label and label[1] else ""
        held = gpu.allocated_bytes >> 20
        return DeviceError(
            f"{gpu.info.name} has no memory left{what}, beside {held} MiB that airlight holds",
            remedy=MEMORY_REMEDY,
        )
    # Any error of a device that is gone comes from its loss, whatever it says.
    return None if is_alive(gpu) else lost(gpu)


def lost(gpu: Gpu) -> DeviceError:
    """The error of a lost device, with its remedy."""
    return DeviceError(f"the device was lost: {gpu.info.name}", remedy=LOST_REMEDY)


def check_memory(nbytes: int) -> None:
    """Raise DeviceError where there are not so many bytes left for the graphics driver."""
    unused = {"prot": 0} if os.name == "posix" else {}  # addresses alone: most are never used
    try:
        mmap(-1, nbytes, **unused).close()
    except (OSError, MemoryError):
        raise DeviceError(
            f"less than {nbytes >> 20} MiB of memory are left for the graphics driver",
            remedy=MEMORY_REMEDY,
        ) from None


def is_alive(gpu: Gpu) -> bool:
    """Whether the device still takes commands.

    It is asked for what is gone when dropped. A command buffer that is never submitted is not:
    wgpu-native keeps it, with the pool of a frame's commands that it was given to reuse.
    """
    try:
        gpu.device.create_bind_group_layout(label="alive", entries=[])
    except Exception:
        return False
    return True


def _is_news(record: logging.LogRecord) -> bool:
    return not str(record.msg).startswith(_LOGGED)


logging.getLogger("wgpu").addFilter(_is_news)
