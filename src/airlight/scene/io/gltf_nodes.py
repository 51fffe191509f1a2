"""The node tree of a glTF file: what hangs where. Transforms are a step of their own, so that
they can be evaluated again for another time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..checks import F64
from .gltf_json import Item


@dataclass(frozen=True, eq=False)
class Node:
    """One node. `rotation` is a quaternion (x, y, z, w); `matrix` (4, 4), where given, replaces
    translation (metres), rotation and scale."""

    item: Item
    children: tuple[int, ...]
    translation: F64
    rotation: F64
    scale: F64
    matrix: F64 | None = None

    def local_matrix(self) -> F64:
        """parent_from_node, (4, 4)."""
        if self.matrix is not None:
            return self.matrix
        return trs_matrix(self.translation, self.rotation, self.scale)


def read_nodes(document: Item) -> tuple[Node, ...]:
    """All nodes, by index."""
    items = document.items("nodes")
    return tuple(_node(item, items) for item in items)


def _node(item: Item, items: Sequence[Item]) -> Node:
    children = tuple(child.pick(items, "nodes") for child in item.items("children"))
    matrix: F64 | None = None
    if item.has("matrix"):
        values = item.floats("matrix", 16, ())
        matrix = np.array(values).reshape(4, 4).T  # stored by columns
    rotation = np.array(item.floats("rotation", 4, (0.0, 0.0, 0.0, 1.0)))
    length = float(np.linalg.norm(rotation))
    return Node(
        item=item,
        children=children,
        translation=np.array(item.floats("translation", 3, (0.0, 0.0, 0.0))),
        rotation=rotation / length if length > 0.0 else np.array((0.0, 0.0, 0.0, 1.0)),
        scale=np.array(item.floats("scale", 3, (1.0, 1.0, 1.0))),
        matrix=matrix,
    )


def trs_matrix(translation: F64, rotation: F64, scale: F64) -> F64:
    """(4, 4): scale, then rotate by the unit quaternion (x, y, z, w), then translate."""
    x, y, z, w = rotation
    turned = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turned * scale
    matrix[:3, 3] = translation
    return matrix


def scene_roots(document: Item, nodes: Sequence[Node]) -> list[int]:
    """Root nodes of the default scene; of the first; or all that are nobody's child."""
    scenes = document.items("scenes")
    if scenes:
        chosen = scenes[document.index("scene", scenes, "scenes") if document.has("scene") else 0]
        return [root.pick(nodes, "nodes") for root in chosen.items("nodes")]
    children = {child for node in nodes for child in node.children}
    return [k for k in range(len(nodes)) if k not in children]


def world_matrices(
    nodes: Sequence[Node], roots: Sequence[int], local: Sequence[F64]
) -> dict[int, F64]:
    """world_from_node (4, 4) of every node reached from the roots, in the file's order.

    `local` are the nodes' parent_from_node matrices. Raises SceneError for a node that is
    reached twice: in a cycle, or as the child of two parents.
    """
    world: dict[int, F64] = {}
    pending = [(root, np.eye(4)) for root in reversed(roots)]
    while pending:
        k, parent = pending.pop()
        if k in world:
            raise nodes[k].item.error("is reached twice: the nodes form a cycle or share a child")
        world[k] = parent @ local[k]
        pending.extend((child, world[k]) for child in reversed(nodes[k].children))
    return world
