"""The tree of media's boxes as rows of their table hold it; `wgsl/media_tree.wgsl` walks it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..maths.box_tree import box_tree
from ..maths.transforms import F64
from .media_slots import has_tree

NO_MEDIUM = 65535
_CORNERS = np.stack(np.meshgrid(*[(0.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


def media_nodes(rows: Sequence[dict[str, Any]], count: int) -> F64:
    """(count, 4, 4): the columns of `MediumData.nodes`; zeros where the media are few.

    Nodes 2i and 2i + 1 lie in row i: as (low, after) and (high, medium).
    """
    nodes = np.zeros((2 * count, 2, 4))
    if has_tree(len(rows)):
        tree = box_tree(*_world_boxes(rows))
        filled = nodes[: len(tree.after)]
        filled[:, 0, :3], filled[:, 0, 3] = tree.low, tree.after
        filled[:, 1, :3], filled[:, 1, 3] = tree.high, tree.box
        filled[tree.box < 0, 1, 3] = NO_MEDIUM
    return nodes.reshape(count, 4, 4)


def _world_boxes(rows: Sequence[dict[str, Any]]) -> tuple[F64, F64]:
    """(n, 3) each: the bounds of media in the world, from their own boxes' corners."""
    to_world = np.linalg.inv(np.array([row["volume_from_world"] for row in rows], np.float64))
    corners = _CORNERS @ np.swapaxes(to_world[:, :3, :3], 1, 2) + to_world[:, None, :3, 3]
    return corners.min(axis=1), corners.max(axis=1)
