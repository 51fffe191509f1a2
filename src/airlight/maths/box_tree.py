"""A tree of boxes that is walked without a stack: what a ray or a point does not meet is skipped.

Boxes are ordered along a Morton curve (Morton1966); a node holds a run of them, its halves are its
children. Nodes lie in preorder, so the next one is the first child, or what follows a skipped node;
which run a node holds depends on the number of boxes alone. `wgsl/media_tree.wgsl` walks it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .transforms import F64

_BITS = 10  # of a Morton code along each axis
_MARGIN = 1e-5  # of a box's reach: single precision must not lose what touches it


@dataclass(frozen=True)
class BoxTree:
    """Nodes in preorder. `low`, `high` (n, 3): their boxes; `after` (n,): the node that follows
    where one is skipped; `box` (n,): which box a leaf is, -1 for others."""

    low: F64
    high: F64
    after: NDArray[np.int64]
    box: NDArray[np.int64]


@lru_cache(maxsize=16)
def _runs(count: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Of `count` boxes: where each node's run begins and ends, and the node after it."""
    first: list[int] = []
    last: list[int] = []
    after: list[int] = []

    # Halves, depth first: whoever leaves a node out goes on at `after`.
    def add(a: int, b: int) -> None:
        node = len(first)
        first.append(a)
        last.append(b)
        after.append(0)
        if b - a > 1:
            add(a, (a + b) // 2)
            add((a + b) // 2, b)
        after[node] = len(first)

    add(0, count)
    return np.array(first), np.array(last), np.array(after)


def box_tree(low: F64, high: F64) -> BoxTree:
    """The tree of at least one box; low, high (boxes, 3)."""
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    order = np.argsort(_morton(0.5 * (low + high)), kind="stable")
    first, last, after = _runs(len(low))
    # The extremes of every run at once: reduceat takes pairs of its begin and end.
    pairs = np.stack([first, last], axis=1).ravel()
    padded = np.concatenate([order, order[-1:]])
    reach = _MARGIN * np.maximum(np.abs(low), np.abs(high)).max() + 1e-9
    node_low = np.minimum.reduceat(low[padded], pairs, axis=0)[::2] - reach
    node_high = np.maximum.reduceat(high[padded], pairs, axis=0)[::2] + reach
    return BoxTree(node_low, node_high, after, np.where(last - first == 1, order[first], -1))


def _morton(points: F64) -> NDArray[np.int64]:
    """Codes of points along a space-filling curve over their bounds."""
    # Cells of a grid over the points' bounds.
    low = points.min(axis=0)
    size = np.maximum(points.max(axis=0) - low, 1e-12)
    cells = np.minimum((points - low) / size * 2**_BITS, 2**_BITS - 1).astype(np.int64)
    code = np.zeros(len(points), np.int64)
    # Bits of the three coordinates interleaved: what is near on the curve is near in space.
    for bit in range(_BITS):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code


def walked(tree: BoxTree, meets: Callable[[F64, F64], bool]) -> tuple[list[int], int]:
    """The boxes that `meets(low, high)`, in the order of the walk, and how many nodes were seen."""
    node, seen, found = 0, 0, []
    while node < len(tree.after):
        seen += 1
        is_met = meets(tree.low[node], tree.high[node])
        if is_met and tree.box[node] >= 0:
            found.append(int(tree.box[node]))
        # A node that is missed skips all below it: no stack is needed.
        node = node + 1 if is_met else int(tree.after[node])
    return found, seen
