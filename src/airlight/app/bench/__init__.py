"""The benchmark: `frames` says what is timed, `child` times a first image in a process of its own.

`pop`, `kernel` and `growth` are its parts, `tables` writes them down.
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
