"""The tree of media's boxes as rows of their table hold it; `wgsl/media_tree.wgsl` walks it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..maths.box_tree import box_tree
from ..maths.transforms import F64
from .media_slots import has_tree

# Stands where there is none: beyond all indices.
NO_MEDIUM = NO_NODE = 65535
_ROOT = 1 << 20  # of what is the root's `after`: beyond all nodes
_BEYOND = 1e30  # m, where boxes lie that there are not
# Of the unit cube (8, 3): a medium's box in the world is that around these.
_CORNERS = np.stack(np.meshgrid(*[(0.0, 1.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


def media_nodes(
    rows: Sequence[dict[str, Any]], count: int, blocks: tuple[int, int, int] | None = None
) -> F64:
    """(count, 4, 4): the columns of `MediumData.nodes`; zeros where the media are few.

    Nodes 2i and 2i + 1 lie in row i: as (low, after) and (high, medium). After the last one, and in
    rows beyond those of media, come nodes that end a walk. `blocks`: of lists of paths along x, y,
    z, which whoever reads such lists finds in the root's `after`, with its box.
    """
    # A walk needs no stack: a node that is missed names the node after its whole subtree.
    nodes = np.zeros((2 * count, 2, 4))
    # Few media are taken one by one, without a tree.
    if has_tree(len(rows)):
        tree = box_tree(*_world_boxes(rows))
        nodes[:] = (_BEYOND, _BEYOND, _BEYOND, NO_NODE)
        filled, after = nodes[: len(tree.after)], np.array(tree.after)
        after[after >= len(after)] = NO_NODE
        filled[:, 0, :3], filled[:, 0, 3] = tree.low, after
        filled[:, 1, :3], filled[:, 1, 3] = tree.high, tree.box
        filled[tree.box < 0, 1, 3] = NO_MEDIUM
        # After the root comes the end in any case, which leaves its field free for the counts.
        nx, ny, nz = blocks or (0, 0, 0)
        nodes[0, 0, 3] = _ROOT | nx | ny << 6 | nz << 12
    return nodes.reshape(count, 4, 4)


def _world_boxes(rows: Sequence[dict[str, Any]]) -> tuple[F64, F64]:
    """(n, 3) each: the bounds of media in the world, from their own boxes' corners."""
    to_world = np.linalg.inv(np.array([row["volume_from_world"] for row in rows], np.float64))
    corners = _CORNERS @ np.swapaxes(to_world[:, :3, :3], 1, 2) + to_world[:, None, :3, 3]
    return corners.min(axis=1), corners.max(axis=1)
