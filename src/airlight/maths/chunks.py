"""Long arrays a piece at a time: temporary arrays stay small and in the processor's cache."""

from __future__ import annotations

from collections.abc import Iterator

CHUNK = 1 << 15
"""Rows of a piece."""


def chunks(count: int, size: int = CHUNK) -> Iterator[slice]:
    """Slices of at most `size` that cover 0 .. count in order; none where `count` is 0."""
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))
