"""A closed mesh as a density grid: the share of every voxel that lies inside."""

from __future__ import annotations

import numpy as np

from .arrays import F64, I64

_LINES_ACROSS = 3
"""Lines per voxel along each axis across them."""
_SHIFTS = 0.6180339887, 0.7548776662
"""From row to row of lines: how far they shift, in distances of lines. Flat faces then lie between
lines in all ways, and not all of them on one side."""
_DIGITS = 1e-9
"""Of a voxel's share: nearer to none, or to all, is just that."""
_PAIRS = 1 << 17
"""Pairs of triangles and lines that are looked at together."""


def solid_voxels(
    positions: F64,
    triangles: I64,
    low: F64,
    high: F64,
    count: tuple[int, int, int],
    *,
    by_parity: bool = False,
) -> F64:
    """(z, y, x), 0..1: what of each of `count` = (x, y, z) voxels of low..high lies inside.

    `positions` (V, 3), `triangles` (T, 3). Lines along x cross the mesh; where more
    faces were entered than left, it is solid (winding number other than 0), so meshes that
    intersect themselves are their union, and parts that face the other way in them are cavities.
    `by_parity`: where an odd number of faces was crossed (Nooruddin2003), whichever way they face.
    A mesh that is not closed (`closing.closed_surface`) loses what a line enters and never leaves.
    """
    nx, ny, nz = count
    # The mesh in voxels along the lines and in lines across them, and where lines cross it.
    across = ny * _LINES_ACROSS, nz * _LINES_ACROSS
    unit = (positions - low) / (high - low) * (nx, *across)
    x, line, sign = _crossings(unit[triangles], across)
    order = np.lexsort((x, line))
    x, line, sign = x[order], line[order], sign[order]
    if len(x) == 0:
        return np.zeros((nz, ny, nx))

    # Behind each crossing: how often the mesh winds around the line so far.
    is_first = np.append(True, line[1:] != line[:-1])
    is_last = np.append(is_first[1:], True)
    start = np.flatnonzero(is_first)[np.cumsum(is_first) - 1]
    passed = np.cumsum(sign)
    winding = passed - (passed - sign)[start]
    odd = (np.arange(len(x)) - start) % 2 == 0
    inside = (odd if by_parity else winding != 0) & ~is_last

    # Where the line goes in or out, all from there on counts, or counts no more.
    change = inside.astype(np.float64)
    change[1:] -= np.where(is_first[1:], 0, inside[:-1])
    x = np.clip(x, 0.0, nx)
    cell = np.floor(x).astype(np.int64)
    k, j = np.divmod(line, across[0])
    row = (k // _LINES_ACROSS * ny + j // _LINES_ACROSS) * (nx + 2) + cell
    # The rest of the voxel that it is in, and all of the next ones.
    held = np.bincount(row, change * (1.0 - (x - cell)), minlength=nz * ny * (nx + 2))
    held += np.bincount(row + 1, change * (x - cell), minlength=len(held))
    sums = np.cumsum(held.reshape(nz, ny, nx + 2), axis=2)[..., :nx]
    # What is full and what is empty is so to the last digit.
    shares = sums / _LINES_ACROSS**2
    shares[shares < _DIGITS] = 0.0
    shares[shares > 1.0 - _DIGITS] = 1.0
    return np.asarray(shares)


def soft_rim(inside: F64) -> F64:
    """The same voxels, each averaged with its neighbours by a tent.

    Between voxels a density is linear. With a rim of shares of voxels alone a dense medium ends
    where the last voxel with any share does, in steps of whole voxels: its outline has teeth. A rim
    three voxels wide has none.
    """
    # A tent of three voxels along one axis after the other.
    for axis in range(3):
        padded = np.moveaxis(np.pad(inside, [(int(i == axis),) * 2 for i in range(3)]), axis, 0)
        mean = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
        inside = np.moveaxis(mean, 0, axis)
    return np.ascontiguousarray(inside)


def _crossings(corners: F64, size: tuple[int, int]) -> tuple[F64, I64, I64]:
    """(x, line, sign) where lines along x cross triangles (T, 3, 3); `size` in (y, z)."""
    # Lines whose place may lie in each triangle's box.
    low_y, high_y = _range(corners[..., 1], size[0])
    low_z, high_z = _range(corners[..., 2], size[1])
    wide, tall = np.maximum(high_y - low_y, 0), np.maximum(high_z - low_z, 0)
    # Each triangle with each line through its box, in flat lists of bounded length.
    ends = np.cumsum(wide * tall)
    found = []
    for first in range(0, int(ends[-1]) if len(ends) else 0, _PAIRS):
        pair = np.arange(first, min(first + _PAIRS, int(ends[-1])))
        triangle = np.searchsorted(ends, pair, side="right")
        place = pair - (ends - wide * tall)[triangle]
        row, along = np.divmod(place, wide[triangle])
        j, k = low_y[triangle] + along, low_z[triangle] + row
        x, sign = _met(
            corners[triangle],
            np.stack([j + (0.5 + k * _SHIFTS[0]) % 1.0, k + (0.5 + j * _SHIFTS[1]) % 1.0], axis=1),
        )
        hit = sign != 0
        found.append((x[hit], (k * size[0] + j)[hit], sign[hit]))
    if not found:
        return np.empty(0), np.empty(0, np.int64), np.empty(0, np.int64)
    x, line, sign = (np.concatenate(part) for part in zip(*found, strict=True))
    return x, line, sign


def _met(corners: F64, at: F64) -> tuple[F64, I64]:
    """x where the lines at (y, z) `at` (N, 2) cross their triangles (N, 3, 3), and from which side:
    1, -1, or 0 for those that miss.

    Of triangles with a common edge just one is met: an edge's side is found from its ends in one
    order, whichever triangle asks, and a line on it counts as beside it by a hair (the symbolic
    perturbation of Edelsbrunner1990).
    """
    areas = []
    for i in range(3):
        a, b = corners[:, (i + 1) % 3, 1:], corners[:, (i + 2) % 3, 1:]
        # The edge in its one order, and its own direction's sign.
        swapped = (a[:, 0] > b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] > b[:, 1]))
        low, high = np.where(swapped[:, None], b, a), np.where(swapped[:, None], a, b)
        along, off = high - low, at - low
        area = along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]
        side = np.where((area >= 0.0) != swapped, 1, -1)
        # Edges without length in this plane have no side, and neither have their triangles.
        areas.append(
            (np.where(swapped, -area, area), np.where((along == 0.0).all(axis=1), 0, side))
        )
    sides = np.stack([side for _, side in areas])
    sign = np.where((sides[0] == sides[1]) & (sides[1] == sides[2]), sides[0], 0)
    # x by the areas across from each corner.
    weights = np.stack([area for area, _ in areas], axis=1)
    whole = weights.sum(axis=1)
    sign = np.where(whole == 0.0, 0, sign)
    x = (weights * corners[..., 0]).sum(axis=1) / np.where(whole == 0.0, 1.0, whole)
    return x, sign


def _range(values: F64, size: int) -> tuple[I64, I64]:
    """Lines first..last + 1 of which any may lie among (T, 3) values."""
    low = np.clip(np.floor(values.min(axis=1)) - 1, 0, size).astype(np.int64)
    high = np.clip(np.floor(values.max(axis=1)) + 1, 0, size).astype(np.int64)
    return low, high
