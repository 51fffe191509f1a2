"""Nodes and triangles of hierarchies as shaders read them, in words of 32 bits.

A node is NODE_WORDS: the corner of its box (3 float32); the steps of its grid, upper halves of
float32 (x, y in one word, z with `axes` and which children there are); lows and highs of its four
children on that grid, a byte each (a word per axis); its children. A triangle is TRIANGLE_WORDS:
three corners (9 float32); the instance that it belongs to where it stands in the world, else
SHARED, and HOLES; texture coordinates of the first corner (2 float32) and of the edges (4 float16);
three normals (octahedra, 2 x 10 bits each).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import U32
from ..maths.chunks import chunks
from ..maths.half import HALF_MAX
from ..maths.octahedron import octahedron_encode
from ..scene.checks import F32
from ..scene.mesh import Geometry
from .hierarchy import INDEX_MASK, LEAF, Hierarchy

NODE_WORDS, TRIANGLE_WORDS = 16, 16
SHARED, HOLES = 1 << 30, 1 << 31
"""Of a triangle's instance: any instance of its geometry shows it; its material may have holes."""
INSTANCE_MASK = SHARED - 1
PRESENT_SHIFT = 6
"""Of a bit for each child, behind the axes of a node."""


def node_words(tree: Hierarchy, lows: F32, highs: F32) -> U32:
    """(N, NODE_WORDS) of a tree and the boxes (N, 4, 3) of its nodes' children.

    The boxes on the grid hold those given: lows are rounded down, highs up.
    """
    # A grid of 255 steps over the box; a step is stored as half of its bits, rounded up.
    rows = np.zeros((len(tree.children), NODE_WORDS), np.uint32)
    corner = lows.min(axis=1)
    corner[~np.isfinite(corner)] = 0.0
    side = np.maximum(highs.max(axis=1).astype(np.float64) - corner, 0.0)
    step = _rounded_up(side / 255.0)
    rows[:, 0:3] = corner.astype(np.float32).view(np.uint32)
    bits = step.view(np.uint32)
    rows[:, 3] = bits[:, 0] >> 16 | bits[:, 1]
    present = ((tree.children > 0) << np.arange(4)).sum(axis=1).astype(np.uint32)
    rows[:, 4] = bits[:, 2] | tree.axes | present << PRESENT_SHIFT
    # The children's boxes on it; one without a box is empty, from the far end to the near one.
    scale = 1.0 / np.maximum(step.astype(np.float64), 1e-300)[:, None, :]
    is_there = np.isfinite(lows[..., :1])
    with np.errstate(invalid="ignore"):
        low = np.floor((lows.astype(np.float64) - corner[:, None]) * scale)
        high = np.ceil((highs.astype(np.float64) - corner[:, None]) * scale)
    low = np.where(is_there, np.clip(low, 0.0, 255.0), 255.0).astype(np.uint32)
    high = np.where(is_there, np.clip(high, 0.0, 255.0), 0.0).astype(np.uint32)
    # Four bytes to a word.
    shift = np.array([0, 8, 16, 24], np.uint32)[:, None]
    rows[:, 5:8] = (low << shift).sum(axis=1, dtype=np.uint32)
    rows[:, 8:11] = (high << shift).sum(axis=1, dtype=np.uint32)
    rows[:, 12:16] = tree.children
    return rows


def _rounded_up(x: NDArray[np.float64]) -> F32:
    """The next float32 whose lower 16 bits are zero."""
    above = np.nextafter(x.astype(np.float32), np.float32(np.inf))
    above = np.where(x > 0.0, above, np.float32(0.0)).astype(np.float32)
    bits = (above.view(np.uint32) + np.uint32(0xFFFF)) & np.uint32(0xFFFF0000)
    return bits.view(np.float32)


def moved_children(children: U32, first_node: int, first_triangle: int) -> U32:
    """Children (..., 4) of a tree whose nodes and triangles begin at these numbers."""
    is_leaf = children >= LEAF
    index = children & INDEX_MASK
    kind = children & ~np.uint32(INDEX_MASK)
    moved = kind | (index + np.where(is_leaf, first_triangle, first_node).astype(np.uint32))
    return np.where(children > 0, moved, np.uint32(0))


def triangle_words(geometry: Geometry, order: NDArray[np.int64]) -> U32:
    """(T, TRIANGLE_WORDS) of a geometry's triangles in this order, SHARED by its instances."""
    rows = np.zeros((len(order), TRIANGLE_WORDS), np.uint32)
    floats, halves = rows.view(np.float32), rows.view(np.float16)
    normals = None if geometry.normals is None else _octahedral(geometry.normals)
    uvs = geometry.uvs
    # Part by part: large meshes have no other copy.
    for part in chunks(len(order)):
        corners = geometry.indices[order[part]]
        floats[part, :9] = geometry.positions[corners].reshape(-1, 9)
        if uvs is not None:
            uv = uvs[corners]
            floats[part, 10:12] = uv[:, 0]
            edges = (uv[:, 1:] - uv[:, :1]).reshape(-1, 4)
            halves[part, 24:28] = np.clip(edges, -HALF_MAX, HALF_MAX)
        if normals is not None:
            a, b, c = (normals[corners[:, k]] for k in range(3))
            rows[part, 14] = a | (b & 0x3FF) << 20
            rows[part, 15] = b >> 10 | c << 10
    return rows


def _octahedral(normals: F32) -> U32:
    """Unit vectors (N, 3) as points of the octahedron's square, 10 bits each; off by .0042 rad."""
    square = np.round((octahedron_encode(normals) + 1.0) * 511.0).astype(np.uint32)
    return np.asarray(square[:, 0] | square[:, 1] << 10)


def triangle_boxes(geometry: Geometry, order: NDArray[np.int64] | None = None) -> tuple[F32, F32]:
    """The lower and upper corners (T, 3) of the boxes of a geometry's triangles, in this order."""
    indices = geometry.indices if order is None else geometry.indices[order]
    a, b, c = (geometry.positions[indices[:, k]] for k in range(3))
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
