"""Sequences: `plan` says which frames, `frames` makes one, `folder` and `video` keep them.

`farm` spreads them over a dask cluster; `whole` knows which are there already; `progress` tells.
"""

from __future__ import annotations

from .cli import command

__all__ = ["command"]
