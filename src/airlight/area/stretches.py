"""Bent and scattered glowing parts in straight stretches: where a segment fits each best."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np

from ..scene.checks import F64, I64

LONG = 2.0
"""Half lengths over the spread across from which on a part is long (a ball: 1.2, a square: 1.7)."""
_CANDIDATES = 24  # places along an axis where a stretch may be divided
_LENGTH = 0.05
"""Of the variance along a stretch, so much counts as what lies off it does: straight ones are
divided evenly where there may be more of them, for their shadows."""


@dataclass(frozen=True, eq=False)
class Moments:
    """Of triangles under even light: `weight` (n,), and sums of places (n, 3) and their squares
    (n, 3, 3), m and m^2 times the weight, which add up.
    """

    weight: F64
    first: F64
    second: F64

    @staticmethod
    def of(corners: F64, weight: F64) -> Moments:
        """Of triangles with `corners` (n, 3, 3), m: their own, not those of their centres."""
        sums = corners.sum(axis=1)
        second = np.einsum("nki,nkj->nij", corners, corners) + np.einsum("ni,nj->nij", sums, sums)
        return Moments(weight, weight[:, None] * sums / 3.0, weight[:, None, None] * second / 12.0)

    def taken(self, rows: I64) -> Moments:
        """Some of them."""
        return Moments(self.weight[rows], self.first[rows], self.second[rows])

    def running(self) -> Moments:
        """Of the first, the first two, and so on."""
        return Moments(*(np.cumsum(v, axis=0) for v in (self.weight, self.first, self.second)))

    def less(self, others: Moments) -> Moments:
        """What others leave of them."""
        return Moments(
            self.weight - others.weight, self.first - others.first, self.second - others.second
        )

    def covariance(self) -> F64:
        """(n, 3, 3) m^2 of each row."""
        # About the mean of the light.
        weight = np.maximum(self.weight, 1e-300)[:, None]
        mean = self.first / weight
        spread: F64 = self.second / weight[..., None] - np.einsum("ni,nj->nij", mean, mean)
        return spread

    def off(self) -> F64:
        """(n,): how far each row's light lies off its principal axis, times its weight."""
        # What lies across the axis, and a little of what lies along it.
        variances = np.maximum(np.linalg.eigvalsh(self.covariance()), 0.0)
        own = variances[:, 0] + variances[:, 1] + _LENGTH * variances[:, 2]
        return np.asarray(self.weight * own)


def principal(corners: F64, areas: F64) -> tuple[F64, F64, F64]:
    """The middle (3,), m, variances (3,), m^2, least first, and axes (3, 3), columns, of triangles
    (n, 3, 3), m, that glow as `areas` (n,) say.
    """
    # Second moments about the middle; the largest variance is along the axis.
    weight = areas / max(float(areas.sum()), 1e-300)
    middle = weight @ corners.mean(axis=1)
    spread = Moments.of(corners - middle, weight).second.sum(axis=0)
    variances, axes = np.linalg.eigh(spread)
    return middle, np.maximum(variances, 0.0), axes


def is_long(corners: F64, areas: F64) -> bool:
    """Whether triangles lie along a line rather than across it."""
    _, variances, _ = principal(corners, areas)
    return bool(3.0 * variances[2] > LONG**2 * (variances[0] + variances[1]))


def stretches(corners: F64, weight: F64, count: int) -> list[I64]:
    """Rows of triangles (n, 3, 3), m, in at most `count` parts, each as near to a line as can be.

    What gains most is divided first, across one of its principal axes.
    """
    # About their middle: squares of large numbers would leave no digits.
    moments = Moments.of(corners - corners.reshape(-1, 3).mean(axis=0), weight)
    # The heap's first gains most by its division; one that is a single triangle ends it.
    heap = [_division(moments, np.arange(len(corners)), 0)]
    while len(heap) < count and heap[0][3]:
        _, _, _, halves = heapq.heappop(heap)
        for half in halves:
            heapq.heappush(heap, _division(moments, half, int(half.min())))
    return [rows for _, _, rows, _ in sorted(heap, key=lambda entry: entry[1])]


_Division = tuple[float, int, I64, tuple[I64, ...]]


def _division(moments: Moments, rows: I64, first: int) -> _Division:
    """What dividing rows brings, below 0; their first, they, and their halves: one row has none."""
    if len(rows) < 2:
        return (0.0, first, rows, ())
    own = moments.taken(rows)
    whole = _total(own)
    # Lights that change their form keep the number of their stretches: there is always a division.
    best = (-1e-300, first, rows, (rows[: len(rows) // 2], rows[len(rows) // 2 :]))
    before = float(whole.off()[0])
    # Candidates along each principal axis: cuts after equal numbers of triangles.
    centres = own.first / np.maximum(own.weight, 1e-300)[:, None]
    _, axes = np.linalg.eigh(whole.covariance()[0])
    for axis in axes.T:
        order = np.argsort(centres @ axis, kind="stable")
        running = own.taken(order).running()
        last = min(_CANDIDATES, len(rows) - 1)
        at = np.unique(np.arange(1, last + 1) * len(rows) // (last + 1)) - 1
        at = at[(at >= 0) & (at < len(rows) - 1)]
        # Running sums of moments give both sides of every cut at once.
        low = running.taken(at)
        after = low.off() + whole.less(low).off()
        least = int(after.argmin())
        # A gain that differs by rounding alone must not decide between axes.
        if after[least] - before < best[0] * (1.0 + 1e-9):
            cut = int(at[least]) + 1
            halves = (rows[order[:cut]], rows[order[cut:]])
            best = (float(after[least] - before), first, rows, halves)
    return best


def _total(moments: Moments) -> Moments:
    sums = (v.sum(axis=0, keepdims=True) for v in (moments.weight, moments.first, moments.second))
    return Moments(*sums)
