"""The hierarchy of one mesh with its nodes and triangles as words, which follows its vertices."""

from __future__ import annotations

from ..scene.mesh import Geometry
from .hierarchy import U32, build, child_boxes, cost
from .words import node_words, triangle_boxes, triangle_words

WORSE = 1.6
"""By which factor fitting may raise the cost of a hierarchy before it is rebuilt."""


class MeshTree:
    """`tree`, `nodes` (N, NODE_WORDS) and `triangles` (T, TRIANGLE_WORDS) of a `geometry`."""

    def __init__(self, geometry: Geometry) -> None:
        self._build(geometry)

    @property
    def nodes_needed(self) -> int:
        """Rows of `nodes`."""
        return len(self.nodes)

    def move(self, geometry: Geometry) -> None:
        """Follow the vertices of the same triangles."""
        if self._fit(geometry) > WORSE * self._built_cost:
            self._build(geometry)

    def _build(self, geometry: Geometry) -> None:
        self.tree = build(*triangle_boxes(geometry))
        self._built_cost = self._fit(geometry)

    def _fit(self, geometry: Geometry) -> float:
        """Boxes around the triangles as they are; returns the cost of the hierarchy."""
        order = self.tree.order
        lows, highs = child_boxes(self.tree, *triangle_boxes(geometry, order))
        self.geometry = geometry
        self.nodes: U32 = node_words(self.tree, lows, highs)
        self.triangles: U32 = triangle_words(geometry, order)
        return cost(self.tree, lows, highs)
