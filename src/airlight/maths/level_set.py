"""The surface where a field on a grid is zero, as triangles: marching tetrahedra (Doi1991).

A cell is six tetrahedra around its diagonal. On each of their edges the field is taken for linear,
which `refined` grids bring near to the trilinear field between the grid's points.
"""

from __future__ import annotations

from itertools import permutations

import numpy as np

from .arrays import F64, I64

# Corners of a cell as bits, x the lowest. Each tetrahedron walks from corner 0 to corner 7 along
# the axes in another order.
_TETRAHEDRA = np.array([(0, a, a | b, 7) for a, b, _ in permutations((1, 2, 4))])


def _triangles_of(inside: int) -> list[list[tuple[int, int]]]:
    """Triangles as three edges each, for the corners that are inside; either way round."""
    within = [k for k in range(4) if inside >> k & 1]
    without = [k for k in range(4) if not inside >> k & 1]
    if len(within) == 2:
        # Around the quadrangle: neighbours share a corner.
        (a, b), (c, d) = within, without
        return [[(a, c), (a, d), (b, d)], [(a, c), (b, d), (b, c)]]
    if len(within) in (1, 3):
        (apex,), others = (within, without) if len(within) == 1 else (without, within)
        return [[(apex, other) for other in others]]
    return []


def refined(values: F64, parts: int) -> F64:
    """A grid (nz, ny, nx) with `parts` cells for each along every axis, by trilinear weights."""
    for axis in range(3):
        count = values.shape[axis]
        at = np.linspace(0.0, count - 1.0, (count - 1) * parts + 1)
        low = np.minimum(at.astype(np.int64), max(count - 2, 0))
        share = (at - low).reshape([-1 if k == axis else 1 for k in range(3)])
        high = np.minimum(low + 1, count - 1)
        values = values.take(low, axis) * (1.0 - share) + values.take(high, axis) * share
    return values


def zero_surface(values: F64) -> tuple[F64, I64]:
    """(V, 3) points and (T, 3) triangles where `values` (nz, ny, nx) are zero.

    Points are (x, y, z) in cells from the first grid point. Seen from where values are positive,
    triangles go counter-clockwise. What touches the grid's rim is open there.
    """
    # Cells whose corners are not all on one side, corners as flat indices of the grid.
    _, ny, nx = values.shape
    strides = np.array([1, nx, nx * ny])
    steps = np.array([sum(strides[k] for k in range(3) if c >> k & 1) for c in range(8)])
    inside = values.ravel() < 0.0
    first = np.arange(values.size).reshape(values.shape)[:-1, :-1, :-1].ravel()
    count = sum(inside[first + step].astype(np.int64) for step in steps)
    cells = first[(count > 0) & (count < 8)]
    # Each tetrahedron by which of its corners are inside; each corner of a triangle is an edge.
    edges: list[I64] = []
    for tetrahedron in _TETRAHEDRA:
        corners = cells[:, None] + steps[tetrahedron]
        code = (inside[corners] * (1, 2, 4, 8)).sum(axis=1)
        for kind in range(1, 15):
            those = corners[code == kind]
            for triangle in _triangles_of(kind):
                edges.append(np.stack([those[:, list(edge)] for edge in triangle], axis=1))
    found = np.concatenate(edges) if edges else np.zeros((0, 3, 2), np.int64)
    # One point for each edge, however many triangles end there.
    ends, numbers = np.unique(np.sort(found.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
    points = _zeros(values.ravel(), ends, nx, ny)
    triangles = numbers.reshape(-1, 3).astype(np.int64)
    return points, _outwards(points, triangles, values)


def _zeros(flat: F64, ends: I64, nx: int, ny: int) -> F64:
    a, b = flat[ends[:, 0]], flat[ends[:, 1]]
    share = np.divide(a, a - b, out=np.full(len(a), 0.5), where=a != b)[:, None]
    low, high = (np.stack([k % nx, k // nx % ny, k // (nx * ny)], axis=1) for k in ends.T)
    return np.asarray(low + share * (high - low))


def _outwards(points: F64, triangles: I64, values: F64) -> I64:
    """The triangles with their fronts to the positive side; those of no area are left out."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    rises = np.einsum("ij,ij->i", normal, gradient_at(values, (a + b + c) / 3.0)) >= 0.0
    turned = np.where(rises[:, None], triangles, triangles[:, ::-1])
    return np.asarray(turned[np.linalg.norm(normal, axis=1) > 1e-12])


def gradient_at(values: F64, points: F64) -> F64:
    """(N, 3) the change by cell of the trilinear field at points (x, y, z) in cells."""
    # Eight corners of the cell around each point.
    size = np.array(values.shape[::-1])
    low = np.clip(np.floor(points).astype(np.int64), 0, size - 2)
    share = points - low
    total = np.zeros((len(points), 3))
    for corner in range(8):
        bits = np.array([corner >> k & 1 for k in range(3)])
        at = low + bits
        value = values[at[:, 2], at[:, 1], at[:, 0]]
        weight = np.where(bits == 1, share, 1.0 - share)
        for axis in range(3):
            others = np.delete(weight, axis, axis=1).prod(axis=1)
            total[:, axis] += (1.0 if bits[axis] else -1.0) * value * others
    return total


def smooth_gradient(values: F64) -> tuple[F64, ...]:
    """Three grids (x, y, z) of central differences by cell, one-sided at the rim."""
    dz, dy, dx = (np.gradient(values, axis=axis) for axis in range(3))
    return dx, dy, dz
