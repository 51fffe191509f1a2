"""The node tree of a glTF file: what hangs where. Transforms are a step of their own, so that
they can be evaluated again for another time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...maths.transforms import trs_matrix
from ..animation.rig import Skeleton
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
    # Exporters round quaternions, and a length other than 1 would scale.
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


def scene_roots(document: Item, nodes: Sequence[Node]) -> list[int]:
    """Root nodes of the default scene; of the first; or all that are nobody's child."""
    scenes = document.items("scenes")
    # The default scene, or else the first; a file without scenes shows all its trees.
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
    # A stack in reverse order, so that nodes come as the file lists them, children after parents.
    pending = [(root, np.eye(4)) for root in reversed(roots)]
    while pending:
        k, parent = pending.pop()
        if k in world:
            raise nodes[k].item.error("is reached twice: the nodes form a cycle or share a child")
        world[k] = parent @ local[k]
        pending.extend((child, world[k]) for child in reversed(nodes[k].children))
    return world


def skeleton(nodes: Sequence[Node], roots: Sequence[int]) -> Skeleton:
    """The nodes at rest, for animations. The tree has been walked by `world_matrices`."""
    # Parents before children, so that one pass over the order places all; a stack, as trees may be
    # deep.
    order: list[tuple[int, int]] = []
    pending = [(root, -1) for root in reversed(roots)]
    while pending:
        k, parent = pending.pop()
        order.append((k, parent))
        pending.extend((child, k) for child in reversed(nodes[k].children))
    count = max(len(nodes), 1)
    return Skeleton(
        order=tuple(order),
        translation=np.array([n.translation for n in nodes]).reshape(count, 3),
        rotation=np.array([n.rotation for n in nodes]).reshape(count, 4),
        scale=np.array([n.scale for n in nodes]).reshape(count, 3),
        matrix={k: n.matrix for k, n in enumerate(nodes) if n.matrix is not None},
    )
