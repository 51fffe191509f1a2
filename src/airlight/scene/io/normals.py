"""Normals for triangles that came without: smooth over gentle bends, sharp at edges."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..checks import F64

I64 = NDArray[np.int64]

CREASE_COSINE = math.cos(math.radians(40.0))
"""Faces that meet at a larger angle do not shade each other's corners."""

_COPLANAR_COSINE = 1.0 - 1e-9
_MAX_FACES_AT_A_VERTEX = 256
_PAIRS_AT_ONCE = 2_000_000


def creased_normals(
    positions: F64, triangles: I64, is_flat: NDArray[np.bool_] | None = None
) -> tuple[F64, I64]:
    """A table of unit normals (N, 3) and the row of it for each triangle's corners (T, 3).

    `positions` (V, 3); `triangles` (T, 3). A corner's normal is the mean, weighted by angle, of
    the faces around its vertex that bend less than 40 degrees from its own: a sphere is round
    and a box keeps its edges. Triangles marked `is_flat` (T,) join only those in their plane.
    Slivers without area join all of their neighbours, and without any they face +Y.
    """
    faces, angles = _faces_and_angles(positions, triangles)
    vertex = triangles.ravel()
    order = np.argsort(vertex, kind="stable")
    starts = np.flatnonzero(np.diff(vertex[order], prepend=-1))
    sizes = np.diff(starts, append=len(vertex))
    around = _Around(faces, angles, order, is_flat)
    sums, keys = np.zeros((len(vertex), 3)), np.zeros(len(vertex), dtype=np.int64)
    corner_pairs = np.cumsum(np.where(sizes > _MAX_FACES_AT_A_VERTEX, sizes, sizes**2))
    cuts = np.searchsorted(corner_pairs, np.arange(0, corner_pairs[-1], _PAIRS_AT_ONCE)[1:])
    for part in np.split(np.arange(len(starts)), np.unique(cuts)):
        if len(part):
            corners = np.arange(starts[part[0]], starts[part[-1]] + sizes[part[-1]])
            sums[order[corners]], keys[order[corners]] = around.sums(starts[part], sizes[part])
    _, first, row = np.unique(keys, return_index=True, return_inverse=True)
    length = np.linalg.norm(sums[first], axis=1, keepdims=True)
    up = np.array((0.0, 1.0, 0.0))
    table = np.where(length > 1e-12, sums[first] / np.maximum(length, 1e-300), up)
    return table, row.reshape(-1, 3)


def _faces_and_angles(positions: F64, triangles: I64) -> tuple[F64, F64]:
    """Unit face normals (T, 3), zero for slivers; angle at each corner (T, 3), radians."""
    corners = positions[triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    faces: F64 = np.where(length > 0.0, cross / np.maximum(length, 1e-300), 0.0)
    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    dot = np.einsum("tkc,tkc->tk", ahead, behind)
    return faces, np.arctan2(length, dot)


class _Around:
    """Sums over the faces around each vertex; corners are numbered sorted by vertex."""

    def __init__(
        self, faces: F64, angles: F64, order: I64, is_flat: NDArray[np.bool_] | None
    ) -> None:
        triangle = order // 3
        self.face = faces[triangle]
        self.weighted = self.face * angles.ravel()[order][:, None]
        self.is_sliver = np.equal(np.abs(self.face).max(axis=1), 0.0)
        self.limit = np.full(len(order), CREASE_COSINE)
        if is_flat is not None:
            self.limit[is_flat[triangle]] = _COPLANAR_COSINE
        # The set of corners that share a normal is known by the sum of their random numbers.
        self.mark = np.random.default_rng(0).integers(-(2**62), 2**62, size=len(order))

    def sums(self, starts: I64, sizes: I64) -> tuple[F64, I64]:
        """For the corners of the vertices that start at `starts`: normal sums and set keys."""
        per_vertex = np.where(sizes > _MAX_FACES_AT_A_VERTEX, 1, sizes)
        count = np.repeat(per_vertex, sizes)
        corners = np.arange(starts[0], starts[0] + sizes.sum())
        first = np.where(count == 1, corners, np.repeat(starts, sizes))
        bounds = np.cumsum(count) - count
        i = np.repeat(corners, count)
        j = np.arange(len(i)) - np.repeat(bounds, count) + np.repeat(first, count)
        cosine = np.einsum("pc,pc->p", self.face[i], self.face[j])
        joined: NDArray[np.bool_] = cosine > self.limit[i]
        joined |= (i == j) | self.is_sliver[i]
        sums = np.add.reduceat(self.weighted[j] * joined[:, None], bounds, axis=0)
        return sums, np.add.reduceat(np.where(joined, self.mark[j], 0), bounds)


def compact(corners: I64) -> tuple[I64, NDArray[np.uint32]]:
    """Distinct rows of `corners` (T, 3, K), each index >= -1, as (V, K), and indices (T, 3)."""
    flat = corners.reshape(-1, corners.shape[-1]) + 1
    spans = flat.max(axis=0) + 1 if len(flat) else np.ones(flat.shape[1], dtype=np.int64)
    if math.prod(int(s) for s in spans) < 2**62:
        key = flat[:, 0].copy()
        for column in range(1, flat.shape[1]):
            key = key * spans[column] + flat[:, column]
        _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    else:
        _, first, inverse = np.unique(flat, axis=0, return_index=True, return_inverse=True)
    return flat[first] - 1, inverse.reshape(-1, 3).astype(np.uint32)
