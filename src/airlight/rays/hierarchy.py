"""A hierarchy of boxes, four to a node, over triangles or over instances.

Built on the host by the surface area heuristic (`sweep`), two divisions to a node. What a node
divides stays as it is when vertices move; boxes are fitted again from the last level to the first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import F32, I64, U32
from .sweep import Boxes, Cuts, Parts, half_area, sweep

LEAF = 1 << 31
"""Bit of a child that is a leaf: 3 bits of its count less 1, 28 bits of its first item."""
COUNT_SHIFT, INDEX_MASK = 28, (1 << 28) - 1
MOST_IN_LEAF = 4
ITEM_COST = 0.5
"""Of a triangle's test, in those of a node's."""
LEVELS = 14
"""Of nodes over the triangles of a mesh; wgsl/rays.wgsl has room for the instances', too."""


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """Nodes, root first, level by level.

    `order` (T,): the items in the order of the leaves; `children` (N, 4) uint32: 0 none, LEAF and
    so on a leaf, else a node's number; `axes` (N,): of the three divisions, 2 bits each, the
    node's and those of its halves; `levels`: the first node of each level, and their number.
    """

    order: I64
    children: U32
    axes: U32
    levels: tuple[int, ...]


def build(low: F32, high: F32, *, most: int = MOST_IN_LEAF, levels: int = LEVELS) -> Hierarchy:
    """A hierarchy over items by their boxes (T, 3), of at most `levels` levels.

    Leaves have at most `most` items. More than `most` * 4^levels items need more levels.
    """
    # Nothing to divide.
    if len(low) < 2:
        alone = np.array([[LEAF if len(low) else 0, 0, 0, 0]], np.uint32)
        return Hierarchy(np.arange(len(low)), alone, np.zeros(1, np.uint32), (0, 1))
    # All nodes of a level at once; each is cut in two, and the halves in two: four children.
    growth = _Growth(most, levels)
    boxes = Boxes.of(low, high)
    items = np.arange(len(low))
    parts = Parts(items, np.zeros(1, np.int64), np.full(1, len(items)))
    room = most << max(2 * levels, 0)
    while len(parts.counts):
        room = max(room >> 1, most)
        # The node's own cut.
        parts, cuts = sweep(parts, boxes, room)
        parts, cuts = growth.begin(parts, cuts)
        if not len(parts.counts):
            break
        # Those of its halves.
        halves = _divided(parts, cuts.before)
        room = max(room >> 1, most)
        halves, half_cuts = sweep(halves, boxes, room)
        parts = growth.finish(halves, half_cuts, cuts.axis)
    return growth.hierarchy


class _Growth:
    """The nodes so far, and whose children the parts of the next level will be."""

    def __init__(self, most: int, levels: int) -> None:
        self.most, self.most_levels = most, levels
        self.order: list[I64] = []
        self.ordered = 0
        self.children: list[U32] = []
        self.axes: list[U32] = []
        self.levels = [0]
        self.parents = np.zeros(1, np.int64)  # node * 4 + slot of each part, in its level

    @property
    def hierarchy(self) -> Hierarchy:
        return Hierarchy(
            np.concatenate(self.order),
            np.concatenate(self.children),
            np.concatenate(self.axes),
            tuple(self.levels),
        )

    def begin(self, parts: Parts, cuts: Cuts) -> tuple[Parts, Cuts]:
        """Make leaves of the parts that are better not divided; returns the others."""
        # The surface area heuristic decides: a leaf where testing all items costs no more than a
        # node and its parts would.
        counts = parts.counts
        is_leaf = (counts <= self.most) & (counts * ITEM_COST <= 1.0 + cuts.cost * ITEM_COST)
        # A single item cannot be divided, and the last level may not be.
        is_leaf |= (counts == 1) | ((counts <= self.most) & (len(self.axes) == self.most_levels))
        if self.axes:
            self._hang(parts, is_leaf)
        else:
            is_leaf[:] = False  # the root is a node
        kept = parts.items[~np.repeat(is_leaf, counts)]
        counts = counts[~is_leaf]
        starts = np.cumsum(counts) - counts
        rest = Parts(kept, starts, counts)
        return rest, Cuts(cuts.before[~is_leaf], cuts.cost[~is_leaf], cuts.axis[~is_leaf])

    def _hang(self, parts: Parts, is_leaf: NDArray[np.bool_]) -> None:
        """Tell the level above which nodes and leaves its children are."""
        # Nodes are numbered level by level: a part's number is its place in its level, behind all
        # nodes above.
        above = self.children[-1].ravel()
        above[self.parents[~is_leaf]] = self.levels[-1] + np.arange((~is_leaf).sum())
        # Leaves store a range of the final order, which they extend by their own items.
        counts = parts.counts[is_leaf]
        first = self.ordered + np.cumsum(counts) - counts
        above[self.parents[is_leaf]] = LEAF | (counts - 1) << COUNT_SHIFT | first
        self.order.append(parts.items[np.repeat(is_leaf, parts.counts)])
        self.ordered += int(counts.sum())

    def finish(self, halves: Parts, cuts: Cuts, axis: I64) -> Parts:
        """Make nodes of pairs of halves; returns their children, up to four of each."""
        # The node's axis and those of its halves, two bits each.
        count = len(axis)
        self.children.append(np.zeros((count, 4), np.uint32))
        self.axes.append((axis | cuts.axis[0::2] << 2 | cuts.axis[1::2] << 4).astype(np.uint32))
        self.levels.append(self.levels[-1] + count)
        # Each half is divided once more where that pays: a node has two to four children.
        counts = halves.counts
        is_cut = (counts > 1) & ((counts > self.most) | (cuts.cost < counts))
        before = np.where(is_cut, cuts.before, counts)
        made = _divided(halves, before)
        is_there = made.counts > 0
        self.parents = np.flatnonzero(is_there)
        return Parts(made.items, made.starts[is_there], made.counts[is_there])


def _divided(parts: Parts, before: I64) -> Parts:
    """Each part as two: its first `before` items, and the rest."""
    counts = np.stack([before, parts.counts - before], axis=1).ravel()
    return Parts(parts.items, np.cumsum(counts) - counts, counts)


def leaf_items(leaves: U32) -> tuple[I64, I64]:
    """The first item of children that are leaves, and how many items each has."""
    words = leaves.astype(np.int64)
    return words & INDEX_MASK, ((words >> COUNT_SHIFT) & 7) + 1


def child_boxes(tree: Hierarchy, low: F32, high: F32) -> tuple[F32, F32]:
    """The boxes (N, 4, 3) of all children, around items of boxes (T, 3) in the tree's order.

    Those of missing children are inside out: infinite low, negative infinite high.
    """
    # Leaves first, whose boxes come from items: the k-th item of all leaves at once.
    count = len(tree.children)
    lows = np.full((count, 4, 3), np.inf, np.float32)
    highs = np.full((count, 4, 3), -np.inf, np.float32)
    leaves = np.flatnonzero(tree.children.ravel() >= LEAF)
    first, counts = leaf_items(tree.children.ravel()[leaves])
    if len(leaves):
        flat_low, flat_high = lows.reshape(-1, 3), highs.reshape(-1, 3)
        for k in range(int(counts.max())):
            at = first + np.minimum(k, counts - 1)
            flat_low[leaves] = np.minimum(flat_low[leaves], low[at])
            flat_high[leaves] = np.maximum(flat_high[leaves], high[at])
    # Nodes hand their boxes to the level above.
    for begin, end in reversed(list(zip(tree.levels[:-1], tree.levels[1:], strict=True))):
        children = tree.children[begin:end]
        node, slot = np.nonzero((children > 0) & (children < LEAF))
        below = children[node, slot]
        lows[begin + node, slot] = lows[below].min(axis=1)
        highs[begin + node, slot] = highs[below].max(axis=1)
    return lows, highs


def cost(tree: Hierarchy, lows: F32, highs: F32) -> float:
    """The surface area heuristic of a tree with boxes of `child_boxes`: tests that a ray makes."""
    # Half the area of each box, and of the whole.
    sides = np.maximum(highs.astype(np.float64) - lows, 0.0)
    areas = half_area(np.moveaxis(sides, -1, 0))
    root = float(half_area(highs[0].max(axis=0).astype(np.float64) - lows[0].min(axis=0)))
    # A child is met with the chance that its box's area is of the whole's; then it costs its
    # tests.
    is_leaf = tree.children >= LEAF
    counts = np.where(is_leaf, leaf_items(tree.children)[1], 0)
    weights = np.where(is_leaf, counts * ITEM_COST, (tree.children > 0) * 1.0)
    return float((areas * weights).sum() / max(root, 1e-300))
