"""The frames of a sequence of files, of which each may hold several times."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from .coefficient_files import main_grid
from .files import naming
from .netcdf import likeliest, time_axes, time_counts
from .netcdf_times import name_and_number, uneven
from .volumes import UPRIGHT_SUFFIXES, grid_names
from .vti import vti_time

Times = tuple[int | None, ...]
"""Of each frame which of its file's times it is, None where that has but one."""


def frames_of(
    files: tuple[Path, ...], grid: str, grids: Mapping[str, str], glowing: str | None = None
) -> tuple[tuple[Path, ...], Times]:
    """The files, each as often as its grids have times, and which time each is.

    `grids` are those of coefficients, which may stand in for the density `grid`; `glowing` is that
    of the emission. A number behind a name chooses one time of each file. Raises SceneError for
    grids of a file that have several times, but not as many as each other.
    """
    frames: list[tuple[Path, int | None]] = []
    for path in files:
        count = _count(path, grid, grids, glowing)
        frames += [(path, k if count > 1 else None) for k in range(count)]
    return tuple(path for path, _ in frames), tuple(time for _, time in frames)


def in_time(files: tuple[Path, ...]) -> tuple[tuple[Path, ...], tuple[float, ...], tuple[str, ...]]:
    """Files that say when they are, by that; their times, none where one does not; what to tell.

    `files` follow each other by the numbers in their names. Raises SceneError.
    """
    if len(files) < 2 or any(path.suffix.lower() != ".vti" for path in files):
        return files, (), ()
    said: list[float] = []
    for path in files:
        with naming(path):
            time = vti_time(path)
        if time is None:
            return files, (), ()
        said.append(time)
    order = sorted(range(len(files)), key=lambda k: said[k])
    times = tuple(said[k] for k in order)
    sorted_files, told = tuple(files[k] for k in order), list[str]()
    if sorted_files != files:
        text = f"{files[0].name} and those after it follow each other by their TimeValue, not by "
        told.append(text + "the numbers in their names")
    told += uneven(np.array(times), f"{files[0].name} and those after it: TimeValue")
    return sorted_files, times, tuple(told)


def counted_grids(path: Path) -> dict[str, int]:
    """The named grids of a file, and how many times each has: 1 where it is static.

    Raises SceneError.
    """
    if path.suffix.lower() not in UPRIGHT_SUFFIXES:
        return dict.fromkeys(grid_names(path), 1)
    with naming(path):
        return time_counts(path)


def time_axes_of(files: tuple[Path, ...]) -> list[dict[str, Any]]:
    """The axes of times of a file, or of those that follow each other: name, units, values, grids.

    Raises SceneError.
    """
    # Files of one time each are an axis together, a file of several has its own.
    if all(path.suffix.lower() == ".vti" for path in files):
        with naming(files[0]):
            times = in_time(files)[1] or tuple(t for t in map(vti_time, files[:1]) if t is not None)
        return [{"name": "TimeValue", "values": list(times)}] if times else []
    if len(files) > 1 or files[0].suffix.lower() not in UPRIGHT_SUFFIXES:
        return []
    with naming(files[0]):
        found = time_axes(files[0])
    return [
        {"name": name, "units": units, "values": values, "grids": grids}
        for name, units, values, grids in found
    ]


def _count(path: Path, grid: str, grids: Mapping[str, str], glowing: str | None) -> int:
    # Only files of simulations hold times.
    if path.suffix.lower() not in UPRIGHT_SUFFIXES:
        return 1
    held = counted_grids(path)
    with naming(path):
        names = [main_grid(list(held), grid, grids), *grids.values()]
        names += [] if glowing is None else [glowing]
        # Grids that are static, or of a time that is chosen, are the same in all frames.
        asked = [name_and_number(name, list(held)) for name in names]
        found = [likeliest(name, list(held)) for name, number in asked if number is None]
        counts = {name: held[name] for name in found if held[name] != 1}
        first = next(iter(counts), None)
        for name, count in counts.items():
            if first is not None and count != counts[first]:
                raise SceneError(
                    f"has {counts[first]} times of '{first}', but {count} of '{name}'",
                    remedy=f'"{name}[0]" takes one time of it.',
                )
        return 1 if first is None else counts[first]
