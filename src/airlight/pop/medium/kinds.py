"""Many volumes in a few kinds: those that are alike in colour, albedo and phase function.

Volumes of a kind share a grid (`merged_medium`), where means of their coefficients stand for each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...scene.coefficients import ALIKE, grouped, traits
from ...scene.volume import Volume
from ..settings import MOST_ALONE, PopSettings
from .merging import mass_of


@dataclass(frozen=True)
class GridPlan:
    """Which grids volumes are solved on.

    volumes  each in its parts
    kinds    of the parts, those that share a grid; none where each volume has its own
    sources  how many grids are marched
    """

    volumes: list[tuple[Volume, ...]]
    kinds: list[tuple[int, ...]]
    sources: int


def grid_plan(parts: Sequence[Volume], settings: PopSettings) -> GridPlan:
    """Few volumes have a grid each, more than MOST_ALONE share those of their kinds."""
    volumes = grouped(parts)
    kinds = sorted_by_kind(parts, settings) if len(volumes) > MOST_ALONE else []
    return GridPlan(volumes, kinds, (len(kinds) or len(volumes)) * settings.grid_levels)


def sorted_by_kind(volumes: Sequence[Volume], settings: PopSettings) -> list[tuple[int, ...]]:
    """The indices of the volumes of each kind, at most MOST_ALONE kinds, each in order.

    Light that hops from cell to cell knows one medium only, so there all are one kind.
    """
    if settings.scheme != "delta-beam":
        return [tuple(range(len(volumes)))]
    rows = np.array([traits(volume) for volume in volumes])
    held = np.array([_held(volume) for volume in volumes])
    # Equal ones first, so that few are compared.
    means, kind_of = np.unique(rows, axis=0, return_inverse=True)
    weight = np.bincount(kind_of.reshape(-1), held, len(means)) + 1e-30
    members = [list(np.flatnonzero(kind_of.reshape(-1) == k)) for k in range(len(means))]
    # The nearest two become one as long as they are alike, or there are too many.
    while len(members) > 1:
        off = np.abs(means[:, None] - means[None, :])
        apart = off.max(axis=-1)
        np.fill_diagonal(apart, np.inf)
        a, b = np.unravel_index(int(np.argmin(apart)), apart.shape)
        if apart[a, b] > ALIKE:
            if len(members) <= MOST_ALONE:
                break
            # Of unlike ones those whose mean changes least what they hold.
            both = weight[:, None] * weight[None, :] / (weight[:, None] + weight[None, :])
            cost = both * (off**2).sum(axis=-1)
            np.fill_diagonal(cost, np.inf)
            a, b = np.unravel_index(int(np.argmin(cost)), cost.shape)
        means[a] = (weight[a] * means[a] + weight[b] * means[b]) / (weight[a] + weight[b])
        weight[a] += weight[b]
        members[a] += members.pop(b)
        means, weight = np.delete(means, b, axis=0), np.delete(weight, b)
    return sorted(tuple(sorted(int(i) for i in kind)) for kind in members)


def _held(volume: Volume) -> float:
    """What a volume counts: its optical cross-section, m^2; an empty grid's if it was full.

    A sequence may begin empty, and its kind stays.
    """
    full = replace(volume, density=None, shape="box")
    return (mass_of(volume) or mass_of(full)) * float(np.mean(volume.sigma_t))
