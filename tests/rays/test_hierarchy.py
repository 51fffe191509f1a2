"""Hierarchies hold every item once, in boxes around it, and are as deep as they may be."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.rays.hierarchy import (
    COUNT_SHIFT,
    INDEX_MASK,
    LEAF,
    LEVELS,
    MOST_IN_LEAF,
    Hierarchy,
    build,
    child_boxes,
    cost,
)
from airlight.rays.words import NODE_WORDS, TRIANGLE_WORDS, moved_children, node_words

RNG = np.random.default_rng(8)


def scattered(count: int) -> np.ndarray:
    return RNG.random((count, 3))


def shrinking(count: int) -> np.ndarray:
    """Each half as far as the one before it, as far as float32 goes: cuts are all lopsided."""
    return np.repeat(0.5 ** np.minimum(np.arange(count), 120)[:, None], 3, axis=1)


def alike(count: int) -> np.ndarray:
    return np.zeros((count, 3))


def boxes(centres: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    low = centres.astype(np.float32)
    return low, (low + np.float32(size)).astype(np.float32)


def depths(tree: Hierarchy) -> int:
    """Levels from the root to the deepest node."""
    depth = np.zeros(len(tree.children), int)
    for node, children in enumerate(tree.children):
        inner = children[(children > 0) & (children < LEAF)]
        depth[inner] = depth[node] + 1
    return int(depth.max()) + 1


@pytest.mark.parametrize("make", [scattered, shrinking, alike])
@pytest.mark.parametrize("count", [1, 2, 3, 9, 1000, 20_000])
def test_every_item_is_in_one_leaf(make: object, count: int) -> None:
    low, high = boxes(make(count), 1e-3)  # type: ignore[operator]
    tree = build(low, high)
    np.testing.assert_array_equal(np.sort(tree.order), np.arange(count))
    leaves = tree.children[tree.children >= LEAF]
    counts = ((leaves >> COUNT_SHIFT) & 7) + 1
    assert counts.max() <= MOST_IN_LEAF and counts.sum() == count
    assert depths(tree) == len(tree.levels) - 1 <= LEVELS
    lows, highs = child_boxes(tree, low[tree.order], high[tree.order])
    root = lows[0].min(axis=0), highs[0].max(axis=0)
    np.testing.assert_array_equal(root, (low.min(axis=0), high.max(axis=0)))
    # Leaves hold what is in them.
    slots = np.flatnonzero(tree.children.ravel() >= LEAF)
    first = (leaves & INDEX_MASK).astype(int)
    assert (lows.reshape(-1, 3)[slots] <= low[tree.order[first]]).all()
    last = first + counts.astype(int) - 1
    assert (highs.reshape(-1, 3)[slots] >= high[tree.order[last]]).all()


def test_few_levels_are_kept_to() -> None:
    """As many items as the levels can hold, where each cut wants to part a few from the rest."""
    low, high = boxes(shrinking(4 * 4**3), 0.0)
    tree = build(low, high, levels=3)
    assert depths(tree) == 3
    leaves = tree.children[tree.children >= LEAF]
    assert (((leaves >> COUNT_SHIFT) & 7) + 1).max() == MOST_IN_LEAF


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e7])
def test_boxes_on_the_grid_hold_those_given(scale: float) -> None:
    low, high = boxes(scale * (RNG.random((3000, 3)) - 0.3), 0.01 * scale)
    high[::3, 1] = low[::3, 1]
    tree = build(low, high)
    lows, highs = child_boxes(tree, low[tree.order], high[tree.order])
    words = node_words(tree, lows, highs)
    corner = words[:, :3].copy().view(np.float32).astype(np.float64)
    bits = np.stack([words[:, 3] << 16, words[:, 3] & 0xFFFF0000, words[:, 4] & 0xFFFF0000], 1)
    step = bits.astype(np.uint32).view(np.float32).astype(np.float64)
    shift = np.array([0, 8, 16, 24], np.uint32)[:, None]
    begin = corner[:, None] + step[:, None] * ((words[:, None, 5:8] >> shift) & 255)
    end = corner[:, None] + step[:, None] * ((words[:, None, 8:11] >> shift) & 255)
    is_there = tree.children > 0
    near = 1e-9 * scale  # of float64
    assert (begin <= lows + near)[is_there].all() and (end >= highs - near)[is_there].all()
    # No wider than two steps of the grid, which has 255 of them a side, at most 1/128 too long.
    side = (highs.max(axis=1) - lows.min(axis=1))[:, None]
    loose = np.maximum(lows - begin, end - highs)[is_there]
    limit = np.broadcast_to(side * (1.0 + 2.0**-7) / 255.0 + near, lows.shape)[is_there]
    assert (loose <= limit).all()


def test_a_triangle_takes_less_than_100_bytes() -> None:
    tree = build(*boxes(scattered(20_000), 0.01))
    assert 4 * (NODE_WORDS * len(tree.children) + TRIANGLE_WORDS * 20_000) < 100 * 20_000


def test_cuts_pay() -> None:
    """A ray tests a small part of what it would without a hierarchy, and less than in disorder."""
    low, high = boxes(scattered(4000), 0.01)
    tree = build(low, high)
    sorted_ = cost(tree, *child_boxes(tree, low[tree.order], high[tree.order]))
    mixed = RNG.permutation(4000)
    disorder = cost(tree, *child_boxes(tree, low[mixed], high[mixed]))
    assert sorted_ < 0.02 * 4000 < disorder


def test_numbers_of_nodes_and_triangles_are_moved() -> None:
    children = np.array([[0, 5, LEAF | 3 << COUNT_SHIFT | 7, LEAF]], np.uint32)
    moved = moved_children(children, 100, 1000)
    expected = [[0, 105, LEAF | 3 << COUNT_SHIFT | 1007, LEAF | 1000]]
    np.testing.assert_array_equal(moved, np.array(expected, np.uint32))
