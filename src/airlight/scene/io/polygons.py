"""Polygons cut into triangles: convex ones into fans, concave ones by ear clipping.

A fan of a concave polygon covers what lies outside of it: an L-shaped face of 7 m^2 becomes one of
16 m^2. Most files hold triangles and convex quads, so polygons are sorted by arrays and only the
few concave ones of more than four corners are clipped one by one.
"""

from __future__ import annotations

import numpy as np

from ...maths.arrays import F64, I64

_AT_ONCE = 1 << 19  # corners whose turns are looked at together
_STRAIGHT = 1e-9  # of a polygon's extent squared: turns that count for none


def triangulated(positions: F64, corners: I64, sizes: I64) -> tuple[I64, I64]:
    """Corner numbers (T, 3) of the triangles, and the polygon (T,) of each.

    `positions` (P, 3); `corners` (C,) their rows, polygon after polygon; `sizes` (F,) corners of
    each polygon; those of fewer than three give nothing. Triangles go round as their polygon does.
    Polygons that are not flat are judged in their mean plane; those without area, or that cross
    themselves so that no ear can be clipped, become fans.
    """
    # A polygon of n corners gives n - 2 triangles, whatever way it is cut.
    count = np.maximum(sizes - 2, 0)
    polygon = np.repeat(np.arange(len(count)), count)
    starts = np.cumsum(sizes) - sizes
    step = np.arange(len(polygon)) - (np.cumsum(count) - count)[polygon]
    first = starts[polygon]
    # Fans of all polygons first; then the concave ones among those of each size are cut otherwise.
    at = np.stack([first, first + step + 1, first + step + 2], axis=1)
    begins = np.cumsum(count) - count
    columns = np.ascontiguousarray(positions.T)
    for size in np.unique(sizes[sizes > 3]).tolist():
        rows = np.flatnonzero(sizes == size)
        # Parts bound the memory.
        for part in np.array_split(rows, -(-len(rows) * size // _AT_ONCE)):
            if size == 4:
                _turn_quads(columns, corners, starts[part], at, begins[part])
            else:
                _cut_concave(positions, corners, starts[part], size, at, begins[part])
    return at, polygon


def _turn_quads(columns: F64, corners: I64, starts: I64, at: I64, begins: I64) -> None:
    """Cut quads by their other diagonal in `at` where the first lies outside of them."""
    # Where the two triangles face different ways the diagonal from b to d may lie inside.
    a, b, c, d = (columns[:, corners[starts + k]] for k in range(4))
    folded = np.flatnonzero(_bend(a, b, c, d) < 0.0)
    a, b, c, d = (corner[:, folded] for corner in (a, b, c, d))
    chosen = folded[_bend(b, c, d, a) > 0.0]
    first, row = starts[chosen], begins[chosen]
    at[row] = np.stack([first + 1, first + 2, first + 3], axis=1)
    at[row + 1] = np.stack([first + 1, first + 3, first], axis=1)


def _bend(a: F64, b: F64, c: F64, d: F64) -> F64:
    """Whether the triangles abc and acd face one way (above 0) or two; corners are (3, F)."""
    u, v, w = b - a, c - a, d - a
    bend: F64 = np.zeros(a.shape[1])
    for i, j in ((0, 1), (1, 2), (2, 0)):
        bend += (u[i] * v[j] - u[j] * v[i]) * (v[i] * w[j] - v[j] * w[i])
    return bend


def _cut_concave(
    positions: F64, corners: I64, starts: I64, size: int, at: I64, begins: I64
) -> None:
    """Replace the fans of the concave ones of polygons of one size, in `at`."""
    number = starts[:, None] + np.arange(size)
    shape = positions[corners[number]]
    # About the polygon's middle, so that products of small differences keep their digits.
    shape = shape - shape.mean(axis=1, keepdims=True)
    ahead = np.roll(shape, -1, axis=1)
    normal = np.cross(shape, ahead).sum(axis=1)  # twice the area, Newell's normal
    # Corners that turn against the polygon's own sense are reflex: their polygons are clipped by
    # ears.
    turn = np.cross(shape - np.roll(shape, 1, axis=1), ahead - shape)
    left = np.einsum("fkc,fc->fk", turn, normal)
    limit = _STRAIGHT * np.square(np.abs(shape).max(axis=(1, 2))) * np.linalg.norm(normal, axis=1)
    is_reflex = left < -limit[:, None]
    # Without such a corner the fan stays.
    for k in np.flatnonzero(is_reflex.any(axis=1)).tolist():
        cut = _clipped(shape[k], normal[k])
        if cut is not None:
            at[begins[k] : begins[k] + size - 2] = starts[k] + cut


def _clipped(shape: F64, normal: F64) -> I64 | None:
    """Triangles (K - 2, 3) of one polygon (K, 3), or None where ears cannot be clipped.

    Where corners in line were left out the last rows are triangles without area.
    """
    import mapbox_earcut

    # The polygon along the axis that it faces most.
    axis = int(np.abs(normal).argmax())
    flat = np.ascontiguousarray(np.delete(shape, axis, axis=1))
    ends = np.array([len(flat)], dtype=np.uint32)
    cut = mapbox_earcut.triangulate_float64(flat, ends).reshape(-1, 3).astype(np.int64)
    if not 0 < len(cut) <= len(flat) - 2:
        return None
    # The triangles have to cover it, and no more.
    a, b, c = flat[cut].transpose(1, 0, 2)
    area = _area(b - a, c - a)
    whole = 0.5 * float(_area(flat, np.roll(flat, -1, axis=0)).sum())
    if not np.isclose(0.5 * np.abs(area).sum(), abs(whole), rtol=1e-6):
        return None  # it crosses itself
    # All the same way around, and as many as a polygon of so many corners has.
    is_turned = area * whole < 0.0
    cut[is_turned] = cut[is_turned][:, ::-1]
    missing = len(flat) - 2 - len(cut)
    return np.concatenate([cut, np.repeat(cut[-1:, [0, 0, 1]], missing, axis=0)])


def _area(u: F64, v: F64) -> F64:
    area: F64 = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return area
