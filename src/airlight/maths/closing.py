"""Triangles as the surface of a solid: holes closed, and whether all of them face one way."""

from __future__ import annotations

import numpy as np

from .arrays import F64, I64
from .weld import connected, open_vertices, welded

_SAME = 2.0**-20


def closed_surface(positions: F64, triangles: I64) -> tuple[F64, I64, int]:
    """Vertices (V, 3), the triangles (T, 3) with their holes closed, and the number of holes.

    Vertices nearer to each other than 2^-20 of the surface's extent become one place. A hole is
    closed by the cone from its rim to the mean of the rim's vertices: a plane rim gets a plane lid.
    Rims are edges of an odd number of triangles. Every vertex has an even number of them, so that
    after closing each edge has an even number of triangles, whatever the mesh was.
    """
    # Vertices on a lattice far finer than any voxel, where seams that were meant to meet do.
    low, extent = positions.min(axis=0), float(np.ptp(positions, axis=0).max())
    step = extent * _SAME if extent > 0.0 else 1.0
    positions = low + step * np.round((positions - low) / step)
    # Edges between welded vertices, each with how often it is run along upwards, less downwards.
    number = welded(positions)
    corners = number[triangles]
    a, b = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    is_edge = a != b
    least, most = np.minimum(a, b)[is_edge], np.maximum(a, b)[is_edge]
    upwards = np.where(a < b, 1, -1)[is_edge]
    edges, which, held = np.unique(
        least * np.int64(len(positions)) + most, return_inverse=True, return_counts=True
    )
    net = np.bincount(which.reshape(-1), weights=upwards, minlength=len(edges))
    is_rim = held % 2 == 1
    if not is_rim.any():
        return positions, triangles, 0

    # The rims' connected parts, each with the mean of its vertices.
    first, last = np.divmod(edges[is_rim], np.int64(len(positions)))
    on_rim = np.unique(np.concatenate([first, last]))
    place = np.empty(int(number.max()) + 1, np.int64)
    place[on_rim] = np.arange(len(on_rim))
    part = connected(len(on_rim), place[first], place[last])
    at = np.empty((int(number.max()) + 1, 3))
    at[number] = positions
    count = np.bincount(part)
    tips = np.stack([np.bincount(part, at[on_rim, k]) / count for k in range(3)], axis=1)

    # A triangle from each edge to its tip, against the way that the surface runs along the edge.
    is_up = net[is_rim] > 0
    tip = len(positions) + part[place[first]]
    one_of = np.empty(int(number.max()) + 1, np.int64)
    one_of[number] = np.arange(len(positions))
    start, end = np.where(is_up, last, first), np.where(is_up, first, last)
    cones = np.stack([one_of[start], one_of[end], tip], axis=1)
    return np.concatenate([positions, tips]), np.concatenate([triangles, cones]), len(tips)


def is_oriented(positions: F64, triangles: I64) -> bool:
    """Whether every edge is run along as often one way as the other: all triangles face out, or
    all of them in."""
    return not bool(open_vertices(welded(positions)[triangles]).any())


def surface_area(positions: F64, triangles: I64) -> float:
    """Of all triangles, to the second power of the positions' unit."""
    a, b, c = np.moveaxis(positions[triangles], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
