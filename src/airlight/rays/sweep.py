"""Where a hierarchy of boxes is divided: the surface area heuristic, a whole level at a time.

The items of each part are sorted along the longest side of the box around their centres, and every
place between two of them is a candidate (MacDonald1990; a full sweep, Wald2007). All parts of a
level are swept at once: minima and maxima run along all items, and a part's offset, larger than
any box, keeps those of the part before it out.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.checks import F64, I64

_APART = 2.0  # between the parts' coordinates, which are within 0 .. 1
_TO_MIDDLE = 1e-9  # of the cost: where all places cost the same, the middle one is taken


@dataclass(frozen=True)
class Boxes:
    """Boxes of items in units of the longest side of the box around all: low, high (3, T).

    `middle` (3, T) are their centres.
    """

    low: F64
    high: F64
    middle: F64

    @classmethod
    def of(cls, low: NDArray[np.float32], high: NDArray[np.float32]) -> Boxes:
        """Those of corners (T, 3), metres."""
        # In the unit of the longest side, so that offsets of parts have one size.
        least, most = low.min(axis=0).astype(np.float64), high.max(axis=0).astype(np.float64)
        scale = 1.0 / max(float((most - least).max()), 1e-300)
        lows, highs = (np.ascontiguousarray(((x - least) * scale).T) for x in (low, high))
        return cls(lows, highs, 0.5 * (lows + highs))


@dataclass(frozen=True)
class Parts:
    """Items in parts: `items` of all parts in order, the first of each part, and how many."""

    items: I64
    starts: I64
    counts: I64

    @property
    def numbers(self) -> I64:
        """The part of each item."""
        return np.repeat(np.arange(len(self.counts)), self.counts)


@dataclass(frozen=True)
class Cuts:
    """Of each part: items before the cut, its cost in items to be tested, its axis."""

    before: I64
    cost: F64
    axis: I64


def sweep(parts: Parts, boxes: Boxes, most: int) -> tuple[Parts, Cuts]:
    """The parts with their items sorted, and where each is best divided.

    No side gets more than `most` items, or both the same number where there are too many for that.
    """
    numbers = parts.numbers
    items, axis = _sorted(parts, numbers, boxes)
    before, after, whole = _areas(items, parts, numbers, boxes)

    # The cost of a cut behind each item.
    index = np.arange(len(items)) - parts.starts[numbers]
    total = parts.counts[numbers]
    left, right = index + 1, total - index - 1
    cost = before * left + after * right
    cost += (_TO_MIDDLE * whole[numbers]) * np.abs(left - right)
    allowed = np.maximum(most, (total + 1) // 2)
    cost[(right == 0) | (left > allowed) | (right > allowed)] = np.inf

    # The first of the cheapest.
    least = np.minimum.reduceat(cost, parts.starts)
    places = np.flatnonzero(cost == least[numbers])[::-1]
    cut = np.empty(len(parts.counts), np.int64)
    cut[numbers[places]] = left[places]
    return Parts(items, parts.starts, parts.counts), Cuts(
        cut, least / np.maximum(whole, 1e-300), axis
    )


def _sorted(parts: Parts, numbers: I64, boxes: Boxes) -> tuple[I64, I64]:
    """The items along the longest side of the box around their centres, and that side's axis."""
    # The box of each part's centres, by reductions over runs of items.
    centres = [middle[parts.items] for middle in boxes.middle]
    least = np.stack([np.minimum.reduceat(c, parts.starts) for c in centres])
    sides = np.stack([np.maximum.reduceat(c, parts.starts) for c in centres]) - least
    axis = sides.argmax(axis=0)
    # Within each part by the share of its own longest side, so that one sort serves all parts.
    along = np.choose(axis[numbers], centres)
    of_part = np.take_along_axis(least, axis[None], axis=0)[0]
    side = np.maximum(np.take_along_axis(sides, axis[None], axis=0)[0], 1e-300)
    share = (along - of_part[numbers]) / side[numbers]
    return parts.items[_order(numbers, share, len(axis))], axis


def _order(numbers: I64, share: F64, count: int) -> I64:
    """The order by part, of which there are `count`, and then by share, 0 to 1.

    Both and the place go into one integer: NumPy sorts values several times faster than places.
    """
    # The share has the bits that part and place leave, enough to tell centres apart.
    place_bits = len(numbers).bit_length()
    share_bits = 62 - place_bits - count.bit_length()
    key = numbers << (place_bits + share_bits)
    key |= (share * ((1 << share_bits) - 1)).astype(np.int64) << place_bits
    key |= np.arange(len(numbers))
    key.sort()
    return key & ((1 << place_bits) - 1)


def _areas(items: I64, parts: Parts, numbers: I64, boxes: Boxes) -> tuple[F64, F64, F64]:
    """Half the areas of the boxes around the items up to each, behind each, and in each part."""
    # The box up to an item and the box from the next one on are the two sides of a cut behind it.
    far: F64 = _APART * numbers.astype(np.float64)
    found = [
        _sides(low[items], high[items], far)
        for low, high in zip(boxes.low, boxes.high, strict=True)
    ]
    up_to = half_area([before for before, _ in found])
    behind = np.zeros_like(up_to)
    behind[:-1] = half_area([after for _, after in found])[1:]
    return up_to, behind, up_to[parts.starts + parts.counts - 1]


def _sides(low: F64, high: F64, far: F64) -> tuple[F64, F64]:
    """Along one axis: sides of the boxes around the items up to each, and from each on."""
    # One running extreme serves all parts: each is shifted so far from the last that the extreme
    # begins again there.
    apart = 2.0 * far
    before = np.maximum.accumulate(high + far)
    before -= np.minimum.accumulate(low - far)
    before -= apart
    after = np.maximum.accumulate((high - far)[::-1])
    after -= np.minimum.accumulate((low + far)[::-1])
    return before, after[::-1] + apart


def half_area(sides: Iterable[F64]) -> F64:
    """Half the areas of boxes by their sides along x, y and z."""
    x, y, z = sides
    return x * y + y * z + z * x
