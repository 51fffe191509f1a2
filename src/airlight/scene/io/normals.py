"""Normals for triangles that came without: smooth over gentle bends, sharp at edges."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...maths.arrays import F64, I64
from ...maths.chunks import chunks

Ints = NDArray[np.integer[Any]]

_CREASE_DEG = 40.0
CREASE_COSINE = math.cos(math.radians(_CREASE_DEG))
"""Faces that meet at a larger angle do not shade each other's corners."""

# Faces within half that angle of their mean are within it of each other; a little less, because
# single precision decides.
_SMOOTH_COSINE = math.cos(math.radians(0.5 * _CREASE_DEG)) + 1e-4
_COPLANAR_COSINE = 1.0 - 1e-9
_MAX_FACES_AT_A_VERTEX = 256
_PAIRS_AT_ONCE = 1 << 17


def creased_normals(
    positions: F64, triangles: Ints, is_flat: NDArray[np.bool_] | None = None
) -> tuple[F64, Ints]:
    """A table of unit normals (N, 3) and the row of it for each triangle's corners (T, 3).

    `positions` (V, 3); `triangles` (T, 3). A corner's normal is the mean, weighted by angle, of
    the faces around its vertex that bend less than 40 degrees from its own: a sphere is round
    and a box keeps its edges. Triangles marked `is_flat` (T,) join only those in their plane.
    Slivers without area join all of their neighbours, and without any they face +Y.
    """
    sums, is_rough = _smooth_sums(positions, triangles)
    if is_flat is not None:
        is_rough[triangles[is_flat]] = True
    # Vertices whose faces all join have one normal, the others one per set of joined faces.
    row_of_vertex = np.cumsum(~is_rough, dtype=triangles.dtype) - 1
    smooth = sums[~is_rough]
    index = row_of_vertex[triangles]
    # Without rough vertices that is all.
    if not is_rough.any():
        return _unit(smooth), index
    # Corners at rough vertices, told apart by their sets of joined faces.
    corner = np.flatnonzero(is_rough[triangles])
    rough_sums, keys = _rough_sums(positions, triangles, corner, is_flat)
    _, first, row = np.unique(keys, return_index=True, return_inverse=True)
    index.ravel()[corner] = len(smooth) + row
    return _unit(np.concatenate([smooth, rough_sums[first]])), index


def _unit(sums: F64) -> F64:
    # A sum of no length has no direction: +Y stands in.
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(length > 1e-12, sums / np.maximum(length, 1e-300), np.array((0.0, 1.0, 0.0)))


def _smooth_sums(positions: F64, triangles: Ints) -> tuple[F64, NDArray[np.bool_]]:
    """Sums (V, 3) of all faces around each vertex, by angle; and which vertices (V,) are rough.

    A vertex is rough where not all of its faces are sure to join: those at an edge, at slivers and
    where very many faces meet.
    """
    # Faces around each vertex, weighted by their angles there.
    count = len(positions)
    sums = np.zeros((3, count))
    faces = np.empty((len(triangles), 3), np.float32)
    is_rough = np.zeros(count, dtype=bool)
    for part in chunks(len(triangles)):
        corners = triangles[part]
        face, angle = _faces_and_angles(positions, corners)
        for axis in range(3):
            np.add.at(sums[axis], corners.ravel(), (face[:, axis, None] * angle).ravel())
        faces[part] = face
        is_rough[corners[~face.any(axis=1)]] = True
    # A vertex is smooth where all of its faces are near their mean.
    means = _unit(sums.T).astype(np.float32)
    for part in chunks(len(triangles)):
        corners = triangles[part]
        cosine = np.einsum("tc,tkc->tk", faces[part], means[corners])
        is_rough[corners[cosine < _SMOOTH_COSINE]] = True
    is_rough |= np.bincount(triangles.ravel(), minlength=count) > _MAX_FACES_AT_A_VERTEX
    return sums.T, is_rough


def _faces_and_angles(positions: F64, triangles: Ints) -> tuple[F64, F64]:
    """Unit face normals (T, 3), zero for slivers; angle at each corner (T, 3), radians."""
    corners = positions[triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    faces: F64 = np.where(length > 0.0, cross / np.maximum(length, 1e-300), 0.0)
    # The angle between the edges to the next corner and to the one before.
    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    dot = np.einsum("tkc,tkc->tk", ahead, behind)
    return faces, np.arctan2(length, dot)


def _rough_sums(
    positions: F64, triangles: Ints, corner: I64, is_flat: NDArray[np.bool_] | None
) -> tuple[F64, I64]:
    """Normal sums (R, 3) and set keys (R,) of the corners `corner` (R,) of `triangles`.

    They are all corners of their vertices.
    """
    # Corners by vertex, all of one vertex in a row.
    vertex = triangles.ravel()[corner]
    order = np.argsort(vertex, kind="stable")
    starts = np.flatnonzero(np.diff(vertex[order], prepend=-1))
    sizes = np.diff(starts, append=len(vertex))
    around = _Around(positions, triangles, corner[order], is_flat)
    sums, keys = np.zeros((len(corner), 3)), np.zeros(len(corner), dtype=np.int64)
    # All pairs of a vertex are compared, so many vertices at a time as fit in memory.
    corner_pairs = np.cumsum(np.where(sizes > _MAX_FACES_AT_A_VERTEX, sizes, sizes**2))
    cuts = np.searchsorted(corner_pairs, np.arange(0, corner_pairs[-1], _PAIRS_AT_ONCE)[1:])
    ends = np.unique(np.append(cuts, len(starts)))
    for low, high in zip(np.append(0, ends[:-1]), ends, strict=True):
        if low < high:
            rows = order[starts[low] : starts[high - 1] + sizes[high - 1]]
            sums[rows], keys[rows] = around.sums(starts[low:high], sizes[low:high])
    return sums, keys


class _Around:
    """Sums over the faces around each vertex; `corners` are numbered sorted by vertex."""

    def __init__(
        self, positions: F64, triangles: Ints, corners: I64, is_flat: NDArray[np.bool_] | None
    ) -> None:
        count = len(corners)
        # Each triangle's normal and angles are computed once for all of its corners.
        triangle = corners // 3
        touched, row = np.unique(triangle, return_inverse=True)
        faces, angles = np.empty((len(touched), 3)), np.empty((len(touched), 3))
        for part in chunks(len(touched)):
            faces[part], angles[part] = _faces_and_angles(positions, triangles[touched[part]])
        self.face = faces[row]
        self.weighted = self.face * angles[row, corners - 3 * triangle][:, None]
        self.is_sliver = np.equal(np.abs(self.face).max(axis=1), 0.0)
        # A flat face joins none but those in its own plane.
        self.limit = np.full(count, CREASE_COSINE)
        if is_flat is not None:
            self.limit[is_flat[triangle]] = _COPLANAR_COSINE
        # The set of corners that share a normal is known by the sum of their random numbers.
        self.mark = np.random.default_rng(0).integers(-(2**62), 2**62, size=count)

    def sums(self, starts: I64, sizes: I64) -> tuple[F64, I64]:
        """For the corners of the vertices that start at `starts`: normal sums and set keys."""
        # Vertices of too many faces have one pair for each corner: with itself.
        per_vertex = np.where(sizes > _MAX_FACES_AT_A_VERTEX, 1, sizes)
        count = np.repeat(per_vertex, sizes)
        corners = np.arange(starts[0], starts[0] + sizes.sum())
        first = np.where(count == 1, corners, np.repeat(starts, sizes))
        bounds = np.cumsum(count) - count
        # Pairs (i, j) of corners of one vertex; a fan of too many faces stays by itself.
        i = np.repeat(corners, count)
        j = np.arange(len(i)) - np.repeat(bounds, count) + np.repeat(first, count)
        # Faces join where they meet at less than the crease's angle.
        cosine = np.einsum("pc,pc->p", self.face[i], self.face[j])
        joined: NDArray[np.bool_] = cosine > self.limit[i]
        joined |= (i == j) | self.is_sliver[i]
        sums = np.add.reduceat(self.weighted[j] * joined[:, None], bounds, axis=0)
        return sums, np.add.reduceat(np.where(joined, self.mark[j], 0), bounds)


def compact(corners: Ints) -> tuple[Ints, NDArray[np.uint32]]:
    """Distinct rows of `corners` (T, 3, K), each index >= -1, as (V, K), and indices (T, 3).

    Rows come in the order of their numbers, the first column first.
    """
    flat = corners.reshape(-1, corners.shape[-1])
    if len(flat) == 0:
        return flat, np.zeros((0, 3), np.uint32)
    # Numbers that are sparse would need large tables: such rows are sorted at once.
    lead = flat[:, 0] + 1
    if int(lead.max()) > 8 * len(flat):
        rows, _, inverse = _sorted_rows(flat)
        return rows, inverse.reshape(-1, 3).astype(np.uint32)
    # Most values of the first column come with one row only; those with several are sorted.
    sample = np.zeros(int(lead.max()) + 1, np.int64)
    is_used = np.zeros(len(sample), dtype=bool)
    is_used[lead] = True
    # Any row of a value may be its sample.
    sample[lead] = np.arange(len(flat))
    # A value is mixed where a row of it differs from its sample.
    is_mixed = np.zeros(len(sample), dtype=bool)
    for part in chunks(len(flat)):
        differs = (flat[part] != flat[sample[lead[part]]]).any(axis=1)
        is_mixed[lead[part][differs]] = True
    several = np.flatnonzero(is_mixed[lead])
    distinct, first, inverse = _sorted_rows(flat[several])
    # Where each value's rows begin; the mixed ones' are in order among themselves.
    counts = is_used.astype(np.int64)
    counts += np.bincount(distinct[:, 0] + 1, minlength=len(counts)) - is_mixed
    starts = np.cumsum(counts) - counts
    within = np.arange(len(distinct)) - np.searchsorted(distinct[:, 0], distinct[:, 0])
    # Where each corner's row will stand: mixed ones by their place within the value.
    indices = starts.astype(np.uint32)[lead]
    indices[several] += within[inverse].astype(np.uint32)
    # Which old row each new one is.
    chosen = np.empty(int(counts.sum()), np.int64)
    single = np.flatnonzero(is_used & ~is_mixed)
    chosen[starts[single]] = sample[single]
    chosen[starts[distinct[:, 0] + 1] + within] = several[first]
    return flat[chosen], indices.reshape(-1, 3)


def _sorted_rows(flat: Ints) -> tuple[Ints, I64, I64]:
    """Distinct rows (V, K) of `flat` (N, K), sorted; the first at which each is; (N,) into them."""
    if len(flat) == 0:
        return flat, np.zeros(0, np.int64), np.zeros(0, np.int64)
    # Columns pack into one 64-bit key where they fit: sorting keys is many times faster than rows.
    spans = [int(s) for s in flat.max(axis=0).astype(np.int64) + 2]
    if math.prod(spans) < 2**62:
        key = flat[:, 0].astype(np.int64) + 1
        for column, span in zip(flat.T[1:], spans[1:], strict=True):
            key = key * span + column + 1
        _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    else:
        _, first, inverse = np.unique(flat, axis=0, return_index=True, return_inverse=True)
    return flat[first], first, inverse.ravel()
