"""Vertices at one position as one vertex, those at rims of surfaces, and connected parts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .chunks import chunks

_FACTORS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)


def welded(points: NDArray[np.floating[Any]]) -> NDArray[np.int64]:
    """A number (V,) for each of the `points` (V, 3): equal where all coordinates are.

    Where all points differ, point k has number k. Numbers go from 0 up, each is used. NaN is not
    allowed.
    """
    # By hashes: where none is there twice, no two points are equal.
    key = _hashes(points)
    ordered = np.sort(key)
    if not (ordered[1:] == ordered[:-1]).any():
        return np.arange(len(points))
    del ordered
    # Equal points stand together once sorted; where hashes collide, coordinates are sorted.
    order = np.argsort(key, kind="stable")
    is_new, is_collision = _changes(points, order, key)
    if is_collision:
        order = np.lexsort(tuple(points.T))
        is_new, _ = _changes(points, order, key)
    numbers = np.empty(len(points), np.int64)
    numbers[order] = np.cumsum(is_new) - 1
    return numbers


def open_vertices(corners: NDArray[np.integer[Any]]) -> NDArray[np.bool_]:
    """Which vertices (V,) lie at a rim: an edge of the triangles `corners` (T, 3) leads to or from
    them that no other runs along the other way. `corners` are numbers as `welded` gives them."""
    # Each vertex adds up random numbers of those that edges lead to, less of those that they come
    # from: where that is zero, the same ones stand on both lists. Numbers of 40 bits add up
    # exactly.
    mark = np.random.default_rng(0).integers(1, 2**40, int(corners.max()) + 1).astype(np.float64)
    balance = np.zeros(len(mark))
    for part in chunks(len(corners)):
        marks = mark[corners[part]]
        change = np.roll(marks, -1, axis=1) - np.roll(marks, 1, axis=1)
        np.add.at(balance, corners[part].ravel(), change.ravel())
    return np.asarray(balance != 0.0)


def edges_of(corners: NDArray[np.int64]) -> NDArray[np.int64]:
    """The ends (3 T, 2), the lesser first, of the edges of triangles (T, 3), one's after the
    other's."""
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
    return np.sort(ends.reshape(-1, 2), axis=1)


def connected(count: int, a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
    """Numbers (count,) of the connected parts of a graph with the edges (E,) from `a` to `b`.

    Numbers go from 0 up in the order of the parts' first nodes, each is used.
    """
    label = np.arange(count)
    while True:
        # Numbers sink along edges until each part has the least of its own.
        lower = label.copy()
        np.minimum.at(lower, a, label[b])
        np.minimum.at(lower, b, label[a])
        lower = lower[lower]  # halves the way to the least
        if (lower == label).all():
            return np.asarray(np.unique(label, return_inverse=True)[1].reshape(-1))
        label = lower


def _hashes(points: NDArray[np.floating[Any]]) -> NDArray[np.uint64]:
    """A 64-bit number (V,) of each point; equal points have equal ones."""
    # Mix the bits of each coordinate into one number.
    key = np.zeros(len(points), np.uint64)
    for column, factor in zip(points.T, _FACTORS, strict=True):
        bits = (column + 0.0).astype(np.float64).view(np.uint64)  # -0 becomes 0
        key = (key ^ bits) * factor
        key ^= key >> np.uint64(29)
    return key


def _changes(
    points: NDArray[np.floating[Any]], order: NDArray[np.int64], key: NDArray[np.uint64]
) -> tuple[NDArray[np.bool_], bool]:
    """Whether each point (V,) differs from the one before it in `order`, and whether any of those
    that do has its hash."""
    # A point is new where any coordinate differs from the one before it.
    is_new = np.zeros(len(order), dtype=bool)
    is_new[0] = True
    for column in points.T:
        values = column[order]
        is_new[1:] |= values[1:] != values[:-1]
    hashes = key[order]
    return is_new, bool((is_new[1:] & (hashes[1:] == hashes[:-1])).any())
