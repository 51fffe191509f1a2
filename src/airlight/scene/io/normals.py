"""Normals for triangles that came without: smooth over gentle bends, sharp at edges."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..checks import F64
from ..mesh import smooth_normals

CREASE_COSINE = math.cos(math.radians(40.0))
"""A face that bends further than this from its vertex's mean normal is shaded flat there."""


def creased_normals(
    positions: F64, triangles: NDArray[np.int64], is_flat: NDArray[np.bool_] | None = None
) -> tuple[F64, NDArray[np.int64]]:
    """A table of normals (V + T, 3) and the row of it for each triangle's corners (T, 3).

    `positions` (V, 3); `triangles` (T, 3). Rows 0 .. V are the vertices' area-weighted
    normals, the rest the faces' own: a corner takes the first where its face bends less than
    40 degrees from it, so that a sphere is round and a box keeps its edges. Triangles marked
    `is_flat` (T,) take the face's everywhere.
    """
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    faces = np.cross(b - a, c - a)
    length = np.linalg.norm(faces, axis=1, keepdims=True)
    faces = np.where(length > 0.0, faces / np.maximum(length, 1e-300), 0.0)
    vertices = smooth_normals(positions.astype(np.float32), triangles.astype(np.uint32)).astype(
        np.float64
    )
    cosine = np.einsum("tkc,tc->tk", vertices[triangles], faces)
    # A sliver without area has no normal of its own.
    smooth = (cosine > CREASE_COSINE) | (length == 0.0)
    if is_flat is not None:
        smooth &= ~is_flat[:, None] | (length == 0.0)
    own = len(positions) + np.arange(len(triangles))[:, None]
    return np.concatenate([vertices, faces]), np.where(smooth, triangles, own)


def compact(
    corners: NDArray[np.int64],
) -> tuple[NDArray[np.int64], NDArray[np.uint32]]:
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
