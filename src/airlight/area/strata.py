"""Pieces in groups: of equal power, or as close together and as alike as so many groups can be."""

from __future__ import annotations

import heapq

import numpy as np

from ..scene.checks import F64, I64


def strata(features: F64, power: F64, count: int) -> list[I64]:
    """`count` groups (fewer where there are not as many rows) of about the same power.

    `features` (n, k): groups are cut across their longest side, again and again.
    """

    def cut(rows: I64, parts: int) -> list[I64]:
        parts = min(parts, len(rows))
        if parts <= 1:
            return [rows]
        # The halves have as much power as their parts shall have, so that all parts end up alike.
        low = parts // 2
        first, second = _halves(features, power, rows, low / parts, low, parts - low)
        return cut(first, low) + cut(second, parts - low)

    return cut(np.arange(len(features)), count)


def clusters(features: F64, power: F64, atoms: I64, most: int) -> list[I64]:
    """At most `most` groups; what is far apart and strong is divided first.

    `atoms` (n,): rows of one number stay together. Rows of no power are left out.
    """
    kept = np.flatnonzero(power > 0.0)
    if not len(kept):
        return []
    # Each atom's power, and its mean features by power.
    numbers, owner = np.unique(atoms[kept], return_inverse=True)
    owner = owner.reshape(-1)
    total = np.bincount(owner, power[kept]).astype(np.float64)
    sums = [np.bincount(owner, power[kept] * column) for column in features[kept].T]
    centre = np.stack(sums, axis=1) / total[:, None]
    # The group of the largest cost is halved, as long as there may be more groups.
    heap = [(-_cost(centre, total, np.arange(len(numbers))), 0, np.arange(len(numbers)))]
    made = 1
    while len(heap) < min(most, len(numbers)):
        cost, _, rows = heapq.heappop(heap)
        if len(rows) < 2:
            heapq.heappush(heap, (0.0, made, rows))
            made += 1
            if cost == 0.0:
                break
            continue
        for half in _halves(centre, total, rows, 0.5, 1, 1):
            heapq.heappush(heap, (-_cost(centre, total, half), made, half))
            made += 1
    # The groups in the order of their first atoms, as rows.
    found = sorted((rows for _, _, rows in heap), key=lambda rows: int(rows.min()))
    return [kept[np.isin(owner, rows)] for rows in found]


def _cost(features: F64, power: F64, rows: I64) -> float:
    """Power times the square of the extent."""
    if len(rows) < 2:
        return 0.0
    return float(power[rows].sum() * (np.ptp(features[rows], axis=0) ** 2).sum())


def _halves(
    features: F64, power: F64, rows: I64, share: float, least_low: int, least_high: int
) -> tuple[I64, I64]:
    """Rows in two across their longest side, the first with `share` of the power."""
    # Across the side that is longest in any of the features.
    axis = int(np.ptp(features[rows], axis=0).argmax())
    # Cut where the running power reaches the share, with enough rows left on either side.
    ordered = rows[np.argsort(features[rows, axis], kind="stable")]
    running = np.cumsum(power[ordered])
    at = int(np.searchsorted(running, share * running[-1] * (1.0 - 1e-9))) + 1
    at = min(max(at, least_low), len(rows) - least_high)
    return ordered[:at], ordered[at:]
