"""Grids of coefficients that a volume's file holds beside its density: `Cd`, albedo, sigma_a."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ...maths.colour import in_rgb
from ..coefficients import as_grids
from ..medium import mean_cosine
from .emission_files import on_one_grid, told_beside
from .files import naming
from .netcdf_times import name_and_number
from .volumes import GridValues, VolumeGrid, grid_names, read_values, read_volume

NAMES = ("sigma_t", "albedo", "sigma_s", "sigma_a", "g")
KEYS = tuple(f"{name}_grid" for name in NAMES)
OF_DENSITY = ("sigma_t", "sigma_s", "sigma_a")
COLOURS = ("Cd", "albedo", "color", "colour")
"""Grids of a file that are its scattering albedo, as the programs that write them name them."""


def taken_grids(values: dict[str, Any]) -> dict[str, str]:
    """The grids that a [[volume]]'s keys name, by coefficient; takes them out of `values`.

    A sigma with a grid is 1 unless it is given.
    """
    found = {name: values.pop(f"{name}_grid") for name in NAMES if f"{name}_grid" in values}
    for name in OF_DENSITY:
        if name in found:
            values.setdefault(name, (1.0, 1.0, 1.0))
    # The phase function has one source: a number for all of the box, or a value per voxel.
    if "g" in found and "g" in values:
        raise SceneError("has g and g_grid", remedy="Keep one of them.")
    return found


def density_or_first(
    path: Path, grid: str, channels: str, grids: Mapping[str, str], time: int | None = None
) -> VolumeGrid:
    """A file's density; of a file with none the first of the `grids` that says where there is any.

    `time` as `read_volume` has it. Raises SceneError.
    """
    # A file that holds the density, or lists no grids, is read as any other.
    stands_in = any(name in grids for name in OF_DENSITY)
    main = main_grid(grid_names(path), grid, grids) if stands_in else grid
    if main == grid:
        return read_volume(path, grid, channels, time)
    # Of three channels the largest: where it is 0, there is no medium.
    found = read_values(path, main, time)
    with naming(path):
        density = found.values if found.values.ndim == 3 else found.values.max(axis=-1)
        if float(density.min(initial=0.0)) < 0.0:
            raise SceneError(f"'{main}' is negative, down to {float(density.min()):g}")
    matrix = found.world_from_volume
    return VolumeGrid(density, found.bounds, found.warnings, matrix, time=found.time)


def main_grid(held: list[str], grid: str, grids: Mapping[str, str]) -> str:
    """`grid`, or the first of `grids` that says where there is any medium, if `grid` is not `held`.

    `held` are the names of a file's grids, none of one that lists none.
    """
    instead = [grids[name] for name in OF_DENSITY if name in grids]
    is_held = not held or name_and_number(grid, held)[0] in held
    return grid if is_held or not instead else instead[0]


def read_coefficients(
    path: Path, density: VolumeGrid, grids: Mapping[str, str], numbers: Mapping[str, Any]
) -> tuple[VolumeGrid, dict[str, Any]]:
    """The density, on a box that holds all `grids` of extinction; and arguments of a Volume.

    `numbers`: the coefficients that were given; those without a grid are in proportion to the
    density. Raises SceneError for what cannot be read, and values that mean nothing.
    """
    read = {name: _read(path, grids[name], name, density.time) for name in grids}
    for found in read.values():
        density = told_beside(density, found.warnings)
    # One box holds all grids of extinction; others are read on it.
    for name in OF_DENSITY:
        if name in read:
            density, _ = on_one_grid(density, read[name])
    placed = {name: on_one_grid(density, found, grows=False)[1] for name, found in read.items()}
    # Without a grid of extinction the file's density stays, and the others lie beside it.
    if not any(name in grids for name in OF_DENSITY):
        return density, {f"{name}_grid": placed[name] for name in grids}
    # Grids times their numbers; what has a number alone is in proportion to the density.
    full: dict[str, Any] = dict.fromkeys((*NAMES[:4],))
    full["g"] = numbers.get("g", 0.0)
    for name in NAMES:
        number = numbers.get(name)
        if name in placed:
            factor = 1.0 if number is None or name == "g" else np.array(number, np.float32)
            full[name] = in_rgb(placed[name]) * factor
        elif number is not None and name in OF_DENSITY:
            full[name] = density.density[..., None] * np.array(number, np.float32)
        elif number is not None and name == "albedo":
            full[name] = number
    # As arguments of a Volume, whose density times tint is the extinction.
    if "g" not in placed:
        full["g"] = mean_cosine(full["g"])
    made = as_grids(full)
    return replace(density, density=made.pop("density"), optics=None), made


def colours_of(path: Path) -> str | None:
    """The grid of a file that is its scattering colour, if it has one."""
    return next((name for name in grid_names(path) if name in COLOURS), None)


def _read(path: Path, grid: str, name: str, time: int | None) -> GridValues:
    found = read_values(path, grid, time)
    with naming(path):
        # A grid is a scalar, or a colour; vector fields such as velocities are neither.
        if found.values.ndim == 4 and found.values.shape[3] != 3:
            raise SceneError(
                f"'{grid}' has {found.values.shape[3]} channels, {name} has one or three"
            )
        if not np.isfinite(found.values).all():
            raise SceneError(f"'{grid}' holds infinite values")
    return found
