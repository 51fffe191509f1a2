"""Comparisons with a reference: `reference` renders it, `result` holds what was found.

`images` makes images of differences, `page` and `style` the sheet that shows them.
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
