"""Where cells are in files of the model WRF, which has it as attributes and potentials."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..checks import F64

_GRAVITY = 9.81  # m s^-2, as WRF has it
_POTENTIALS = ("PH", "PHB")


def wrf_lines(dataset: Any, time: str | None, number: int) -> dict[str, F64]:
    """Centres of cells, m, by dimension, at time `number` along the dimension `time`, if any.

    Heights are those of the geopotential's mean over each level; levels rise and fall with time.
    Empty for files of others.
    """
    lines = {}
    for name, key in (("west_east", "DX"), ("south_north", "DY")):
        if key in dataset.attrs and name in dataset.sizes:
            lines[name] = (np.arange(dataset.sizes[name]) + 0.5) * float(dataset.attrs[key])
    if all(name in dataset and "bottom_top_stag" in dataset[name].dims for name in _POTENTIALS):
        # Each has its own times, or none; all but the level and the plane is one of them.
        parts = [_at(dataset[name], time, number) for name in _POTENTIALS]
        # Levels lie between the edges of a staggered grid.
        edges = (parts[0] + parts[1]) / _GRAVITY
        lines["bottom_top"] = 0.5 * (edges[1:] + edges[:-1])
    return lines


def _at(potential: Any, time: str | None, number: int) -> F64:
    """The mean (levels,) of a potential at a time."""
    kept = ("bottom_top_stag", "south_north", "west_east")
    others = {d: number if d == time else 0 for d in potential.dims if d not in kept}
    across = [d for d in kept[1:] if d in potential.dims]
    return np.asarray(potential.isel(others).mean(across).values, np.float64)
