"""The frames of a sequence of files, of which each may hold several times."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from .coefficient_files import main_grid
from .files import naming
from .netcdf import time_count
from .netcdf_times import name_and_number
from .volumes import UPRIGHT_SUFFIXES, grid_names

Times = tuple[int | None, ...]
"""Of each frame which of its file's times it is, None where that has but one."""


def frames_of(
    files: tuple[Path, ...], grid: str, grids: Mapping[str, str]
) -> tuple[tuple[Path, ...], Times]:
    """The files, each as often as it has times of `grid`, and which time each is.

    `grids` are those of coefficients, which may stand in for a density. A number behind the name of
    `grid` chooses one time of each file. Raises SceneError.
    """
    frames: list[tuple[Path, int | None]] = []
    for path in files:
        count = _count(path, grid, grids)
        frames += [(path, k if count > 1 else None) for k in range(count)]
    return tuple(path for path, _ in frames), tuple(time for _, time in frames)


def _count(path: Path, grid: str, grids: Mapping[str, str]) -> int:
    # Only files of simulations hold times.
    if path.suffix.lower() not in UPRIGHT_SUFFIXES:
        return 1
    with naming(path):
        held = grid_names(path)
        if name_and_number(grid, held)[1] is not None:
            return 1
        return time_count(path, main_grid(held, grid, grids))
