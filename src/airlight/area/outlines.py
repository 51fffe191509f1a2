"""Which emitters are, as they are seen, nothing but their polygon, so that its part of a pixel is
the glow's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..scene.checks import F64
from .emitter import Emitter
from .pieces import Pieces
from .shapes import Shape

_EXACT = 1e-3  # of its size


def is_outline(shape: Shape, group: Pieces) -> bool:
    """Whether a polygon is exactly the surface of a group, and all of that glows alike."""
    if shape.corners is None:
        return False
    points = group.corners.reshape(-1, 3)
    # Each of the polygon's corners is one of a piece: none was cut off or bridged.
    apart = np.linalg.norm(shape.corners[:, None] - points, axis=-1).min(axis=1)

    # The polygon's area, by triangles about its centre.
    turned = np.cross(shape.corners - shape.centre, np.roll(shape.corners, -1, 0) - shape.centre)
    area = 0.5 * float(np.linalg.norm(turned.sum(axis=0)))
    # Pieces that glow alike and leave no gap: their areas add up to the polygon's.
    is_even = bool((np.ptp(group.radiance, axis=0) <= _EXACT * group.radiance.max()).all())
    is_filled = abs(float(group.areas.sum()) - area) <= _EXACT * area
    return is_even and is_filled and float(apart.max()) <= _EXACT * shape.radius


def apart(emitters: Sequence[Emitter]) -> tuple[Emitter, ...]:
    """The emitters; those that lie over each other in one plane are not outlined.

    There, which one is seen is left to rounding, and their parts of a pixel do not add up.
    """
    rows = [row for row, emitter in enumerate(emitters) if emitter.is_outlined]
    shapes = {row: emitters[row].shape for row in rows}
    # Both of a pair that overlaps go back to what the G-buffer sees of them.
    over = {
        row
        for i, first in enumerate(rows)
        for second in rows[i + 1 :]
        if _overlap(shapes[first], shapes[second])
        for row in (first, second)
    }
    return tuple(
        replace(emitter, is_outlined=False) if row in over else emitter
        for row, emitter in enumerate(emitters)
    )


def _overlap(a: Shape, b: Shape) -> bool:
    """Whether polygons lie in one plane, and no edge of either has all of the other beyond it."""
    # Polygons far from one plane, or facing apart, do not cover each other.
    radius = max(a.radius, b.radius)
    if abs(float((b.centre - a.centre) @ a.normal)) > 2.0 * _EXACT * radius:
        return False
    if float(a.normal @ b.normal) < 0.999 or a.corners is None or b.corners is None:
        return False
    return not (_splits(a.corners, b.corners, radius) or _splits(b.corners, a.corners, radius))


def _splits(corners: F64, others: F64, radius: float) -> bool:
    # Outward normals of the first polygon's edges, in its plane.
    after = np.roll(corners, -1, axis=0)
    normal = np.cross(after - corners, np.roll(after, -1, axis=0) - after).sum(axis=0)
    outward = np.cross(after - corners, normal)
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-30)

    # An edge that has all other corners beyond it parts the two.
    off = np.einsum("ekx,ex->ek", others - corners[:, None], outward)
    return bool((off.min(axis=1) > -_EXACT * radius).any())
