"""Rows of many numbers as mixtures of a few: voxels whose coefficients are few materials' mixed.

Where the rows are non-negative mixtures of a few of themselves (smoke of three colours, dust in
fog), those few are found by successive projection (Araujo2001; Gillis2014); else every
number is a material of its own, which is always exact.
"""

from __future__ import annotations

import numpy as np

from .arrays import F32, F64

EXACT = 0.004
"""Of a row's sum: mixtures may be off by so much, a step of colours in 8 bits."""
_FAINT = 1e-4  # of the largest row's sum; of fainter rows nothing is asked
_FIRST = 65536  # rows that a basis is tried on before all


def mixed(rows: F32) -> tuple[F32, F64]:
    """(shares (n, k), materials (k, m)) with shares @ materials = `rows` (n, m), all >= 0.

    As few materials as EXACT allows. `rows` of zeros alone give k = 0.
    """
    # Rows without anything need no material.
    sums = rows.sum(axis=1, dtype=np.float64)
    largest = float(sums.max(initial=0.0))
    if largest <= 0.0:
        return np.zeros((len(rows), 0), np.float32), np.zeros((0, rows.shape[1]))
    # By colour alone, of rows whose colours are more than rounding.
    seen = np.flatnonzero(sums > _FAINT * largest)
    colours = (rows[seen] / sums[seen, None]).astype(np.float64)
    tried = colours[:: -(-len(colours) // _FIRST)]
    # A vertex more as long as it helps; more vertices than half of the numbers save little.
    picked: list[int] = []
    left = tried.copy()
    for _ in range(max(1, rows.shape[1] // 2 + 1)):
        # Farthest from the span of those picked: a vertex of the hull (successive projection).
        strongest = int(np.argmax(np.einsum("ij,ij->i", left, left)))
        direction = left[strongest]
        length2 = float(direction @ direction)
        if length2 < EXACT**2:
            break
        picked.append(strongest)
        left = left - np.outer(left @ direction / length2, direction)
        materials = tried[picked]
        if _holds(tried, materials) and _holds(colours, materials):
            return np.maximum(rows @ np.linalg.pinv(materials), 0.0).astype(np.float32), materials
    return _by_number(rows)


def _holds(colours: F64, materials: F64) -> bool:
    """Whether all colours are mixtures of the materials."""
    # The shares that fit best, cut at 0, against the colours themselves.
    shares = colours @ np.linalg.pinv(materials)
    off = np.abs(np.maximum(shares, 0.0) @ materials - colours).max(initial=0.0)
    return bool(off <= EXACT)


def _by_number(rows: F32) -> tuple[F32, F64]:
    """Each number a material; numbers that are everywhere in one ratio share theirs."""
    groups: list[list[int]] = []
    # Columns in one ratio join the group of the first that they are in ratio with.
    for column in range(rows.shape[1]):
        own = rows[:, column]
        if not own.any():
            continue
        for group in groups:
            other = rows[:, group[0]]
            ratio = float(own.max()) / float(other.max())
            if float(np.abs(own - ratio * other).max()) <= EXACT * float(own.max()):
                group.append(column)
                break
        else:
            groups.append([column])
    # A group's first column stands for it; the others are so many times as much.
    shares = np.stack([rows[:, group[0]] for group in groups], axis=1)
    materials = np.zeros((len(groups), rows.shape[1]))
    for k, group in enumerate(groups):
        materials[k, group] = [float(rows[:, c].max() / rows[:, group[0]].max()) for c in group]
    return np.ascontiguousarray(shares, np.float32), materials
