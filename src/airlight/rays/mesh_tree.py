"""The hierarchy of one mesh with its nodes and triangles as words, which follows its vertices."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..maths.arrays import U32
from ..scene.mesh import Geometry, Mesh, in_world
from .cached import built
from .hierarchy import Hierarchy, child_boxes, cost
from .words import (
    HOLES,
    INSTANCE_MASK,
    SHARED,
    TRIANGLE_WORDS,
    node_words,
    triangle_boxes,
    triangle_words,
)

WORSE = 1.6
"""By which factor fitting may raise the cost of a hierarchy before it is rebuilt."""


class MeshTree:
    """`tree`, `nodes` (N, NODE_WORDS) and `triangles` (T, TRIANGLE_WORDS) of a `geometry`."""

    def __init__(self, geometry: Geometry, *, has_holes: bool = False) -> None:
        """`has_holes`: whether the material of any of its instances has."""
        self._flags = SHARED | HOLES * has_holes
        self._build(geometry)

    def move(self, geometry: Geometry) -> None:
        """Follow the vertices of the same triangles."""
        # Boxes are fitted; the tree is rebuilt only where that has made it much worse.
        if self._fit(geometry) > WORSE * self._built_cost:
            self._build(geometry)

    def _build(self, geometry: Geometry) -> None:
        self.tree: Hierarchy = built(*triangle_boxes(geometry))
        self._built_cost = self._fit(geometry)

    def _fit(self, geometry: Geometry) -> float:
        """Boxes around the triangles as they are; returns the cost of the hierarchy."""
        order = self.tree.order
        lows, highs = child_boxes(self.tree, *triangle_boxes(geometry, order))
        self.geometry = geometry
        self.nodes: U32 = node_words(self.tree, lows, highs)
        self.triangles: U32 = triangle_words(geometry, order)
        self.triangles[:, 9] = self._flags
        return cost(self.tree, lows, highs)


class StillTree:
    """One hierarchy over all static instances, their triangles in the world.

    An instance that moves is hidden: its triangles have no area, and are in no box.
    """

    def __init__(
        self, meshes: Sequence[Mesh], instances: Sequence[int], has_holes: Sequence[bool]
    ) -> None:
        """`meshes` of all instances, in the scene's order, and whether their materials have holes;
        `instances`: those that it holds."""
        # Triangles of all instances, in the world, each with its instance's number.
        parts = [in_world(meshes[index]) for index in instances]
        words = [triangle_words(part, np.arange(len(part.indices))) for part in parts]
        for index, rows in zip(instances, words, strict=True):
            rows[:, 9] = index | HOLES * has_holes[index]
        boxes = [triangle_boxes(part) for part in parts]
        triangles = np.concatenate(words) if words else np.zeros((0, TRIANGLE_WORDS), np.uint32)
        low, high = (
            np.concatenate([box[k] for box in boxes]) if boxes else np.zeros((0, 3), np.float32)
            for k in range(2)
        )
        # Stored in the tree's order: a leaf is a run of them.
        self.tree = built(low, high)
        order = self.tree.order
        self._all: U32 = triangles[order]
        self.triangles = self._all
        self._low, self._high = low[order], high[order]
        self.instances = self._all[:, 9] & INSTANCE_MASK
        self._hidden: frozenset[int] = frozenset()
        self._fit(self._low, self._high)

    def hide(self, instances: frozenset[int]) -> bool:
        """Hide just these instances; returns whether others were hidden before."""
        if instances == self._hidden:
            return False
        self._hidden = instances

        # Hidden triangles lose their area, and boxes of nothing but them are empty.
        is_hidden = np.isin(self.instances, list(instances))[:, None]
        self.triangles = self._all.copy()
        self.triangles[:, :9] = np.where(is_hidden, 0, self._all[:, :9])
        self._fit(np.where(is_hidden, np.inf, self._low), np.where(is_hidden, -np.inf, self._high))
        return True

    def _fit(self, low: np.ndarray, high: np.ndarray) -> None:
        # The box around everything that is not hidden.
        lows, highs = child_boxes(self.tree, low.astype(np.float32), high.astype(np.float32))
        self.nodes: U32 = node_words(self.tree, lows, highs)
        corners = np.concatenate([lows[0], highs[0]])
        self.bounds = corners[np.isfinite(corners).all(axis=1)]
