"""Scopes: who releases memory of the device. Each owns what is created with it.

device   the outermost scope; counts the bytes of all
scope    of a Renderer, a technique, or a part that is dropped before its owner
resource a buffer, a texture, a recording: owned by the scope that it was created with
"""

from __future__ import annotations

import threading
from typing import Protocol
from weakref import WeakSet


class Owned(Protocol):
    """A resource of a scope, or a scope within it."""

    def release(self) -> None:
        """Give the memory back; once more it does nothing."""


class Memory:
    """Bytes that are allocated on one device, and the most there were; any thread may count."""

    def __init__(self) -> None:
        self.allocated_bytes = 0
        self.peak_bytes = 0
        self._counting = threading.RLock()  # a destructor may count in the midst of it

    def count(self, nbytes: int) -> None:
        """So much more (or less) is allocated."""
        with self._counting:
            self.allocated_bytes += int(nbytes)  # NumPy integers, too: JSON knows none
            self.peak_bytes = max(self.peak_bytes, self.allocated_bytes)

    def forget_peak(self) -> None:
        """From here on the peak is counted afresh."""
        with self._counting:
            self.peak_bytes = self.allocated_bytes


class Scope:
    """An owner of resources, which `release` gives back as a whole.

    A scope does not keep what it owns alive: a resource that nobody refers to is gone before.
    """

    def __init__(self) -> None:
        self._owned: WeakSet[Owned] = WeakSet()

    def own(self, resource: Owned) -> None:
        """Release `resource` with all else."""
        self._owned.add(resource)

    def release(self) -> None:
        """Give back all that was made in this scope and in those within it.

        The scope may be used again: it then owns what is made from here on.
        """
        for resource in tuple(self._owned):
            resource.release()
        self._owned.clear()
