"""The tree of boxes finds what a look at each of them finds, and sees few nodes for it."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.box_tree import box_tree, walked

RNG = np.random.default_rng(5)


def boxes(count: int) -> tuple[np.ndarray, np.ndarray]:
    low = RNG.uniform(-3.0, 3.0, (count, 3))
    return low, low + RNG.uniform(0.0, 0.6, (count, 3))


@pytest.mark.parametrize("count", [1, 2, 9, 100])
def test_points_find_the_boxes_that_hold_them(count: int) -> None:
    low, high = boxes(count)
    tree = box_tree(low, high)
    assert sorted(tree.box[tree.box >= 0]) == list(range(count))
    for p in RNG.uniform(-3.0, 3.0, (50, 3)):
        found, _ = walked(tree, lambda a, b, p=p: bool(np.all(p >= a) and np.all(p <= b)))
        held = np.flatnonzero(np.all((p >= low) & (p <= high), axis=1))
        assert sorted(found) == list(held)


def test_a_ray_sees_a_share_of_many_boxes() -> None:
    """Of 256 small boxes a ray meets a few; it sees fewer than a quarter of the nodes."""
    low, high = boxes(256)
    tree, seen = box_tree(low, high), []
    for _ in range(40):
        eye, direction = RNG.uniform(-4, 4, 3), RNG.normal(size=3)

        def meets(a: np.ndarray, b: np.ndarray, o=eye, d=direction) -> bool:
            near, far = np.minimum((a - o) / d, (b - o) / d), np.maximum((a - o) / d, (b - o) / d)
            return bool(max(near.max(), 0.0) <= far.min())

        found, count = walked(tree, meets)
        assert set(i for i in range(256) if meets(low[i], high[i])) <= set(found)
        seen.append(count)
    assert np.mean(seen) < 0.25 * len(tree.after)


def test_a_node_holds_its_children() -> None:
    tree = box_tree(*boxes(33))
    for node, after in enumerate(tree.after):
        assert node < after <= len(tree.after)
        assert np.all(tree.low[node] <= tree.low[node:after].min(axis=0))
        assert np.all(tree.high[node] >= tree.high[node:after].max(axis=0))
