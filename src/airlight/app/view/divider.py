"""The line between two techniques' images: whose they are, and where a hand takes it."""

from __future__ import annotations

from collections.abc import Iterator

from .gizmos import Colour, Mark
from .projection import Projection

_PALE: Colour = (0.94, 0.94, 0.94)
_TEXT_PX, _TOP_PX, _BESIDE_PX, _GRIP_PX = 13.0, 26.0, 12.0, 6.0


def divider_marks(split: float, left: str, right: str, seen: Projection) -> Iterator[Mark]:
    """A grip on the line at a `split` of the width, and beside it the names of both images."""
    width, height = seen.size
    x = round(split * width, 1)
    yield Mark("dot", ((x, round(height / 2.0, 1)),), _PALE, _GRIP_PX)
    for name, side in (left, -1.0), (right, 1.0):
        at = (x + side * _BESIDE_PX, _TOP_PX)
        yield Mark("text", (at,), _PALE, _TEXT_PX, name, ends_here=side < 0.0)
