"""Triangle ids by the provoking vertex.

A flat interpolant has the value of a triangle's first vertex. Where no two triangles share that
vertex, it may be the triangle's number, and indexed vertices are still shaded once for many
triangles.
"""

from __future__ import annotations

import numpy as np

from ..maths.arrays import U32


def unique_provoking(indices: U32) -> tuple[U32, U32]:
    """Vertices reordered and copied so that vertex t is the first one of triangle t.

    `indices` (T, 3) -> sources (V',), the vertex that each new one is a copy of, and indices (T, 3)
    into them. The other corners are copies that are first in a triangle near by, so that few
    vertices are shaded; vertices that are first nowhere come last.
    """
    count = len(indices)
    first = indices[:, 0].astype(np.int64)
    # Copies in the order of their vertex, then of their triangle.
    order = np.lexsort((np.arange(count), first))
    keys = first[order] * count + order
    # Vertices that are corners and first in no triangle go to the end, once each.
    is_first = np.zeros(int(indices.max(initial=0)) + 1, dtype=bool)
    is_last = is_first.copy()
    is_first[first] = True
    is_last[indices[:, 1:]] = True
    is_last &= ~is_first
    last = np.flatnonzero(is_last)
    number_of_last = np.cumsum(is_last) - 1
    # Other corners take the copy that is nearest in the order of triangles.
    corners = np.empty((count, 3), np.uint32)
    corners[:, 0] = np.arange(count)
    for corner in (1, 2):
        wanted = indices[:, corner].astype(np.int64)

        # A vertex's copies lie in a row of the sorted keys: those around this triangle.
        after = np.searchsorted(keys, wanted * count + np.arange(count))
        before = np.maximum(after - 1, 0)
        after = np.minimum(after, count - 1)
        is_before, is_after = first[order[before]] == wanted, first[order[after]] == wanted
        extra = count + number_of_last[wanted]
        corners[:, corner] = np.where(
            is_before, order[before], np.where(is_after, order[after], extra)
        )
    return np.concatenate([first, last]).astype(np.uint32), corners
