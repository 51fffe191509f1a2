"""Emission and temperature grids of a volume's file, on the voxels of its density."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...errors import SceneError
from ..checks import F32
from ..emission import WHITE, Emission
from ..one_grid import GridBox
from .files import naming
from .volumes import GridValues, VolumeGrid, read_values

KEYS = ("temperature_scale", "temperature_offset")


def taken_emission(
    values: dict[str, Any], path: Path | None, density: VolumeGrid | None
) -> tuple[Emission | None, VolumeGrid | None]:
    """The emission that a [[volume]]'s keys describe; takes them out of `values`.

    The density comes back on a larger box where the emission reaches beyond its own. Raises
    SceneError for what cannot be read, a temperature below 0 K, and keys that do not fit.
    """
    # All keys are taken out, also those that are wrong together: what stays belongs to others.
    wanted, hot = values.pop("emission_grid", None), values.pop("temperature_grid", None)
    given = {name: values.pop(name) for name in KEYS if name in values}
    radiance = values.pop("emission", None)
    # Keys that contradict each other, or have nothing to describe.
    if wanted is not None and hot is not None:
        raise SceneError("has an emission_grid and a temperature_grid", remedy="Keep one of them.")
    if given and hot is None:
        raise SceneError(f"{next(iter(given))} belongs to a temperature_grid")
    if wanted is None and hot is None:
        # Without a grid the emission is in proportion to the density.
        return (Emission(radiance) if radiance else None), density
    if path is None or density is None:
        name = "emission_grid" if hot is None else "temperature_grid"
        raise SceneError(f"{name} belongs to a file, not to a shape")
    # Density and emission, on one grid that holds both.
    with naming(path):
        found = read_values(path, wanted or hot or "", density.time)
        if hot is not None and found.values.ndim != 3:
            raise SceneError(f"'{hot}' has {found.values.shape[3]} channels, a temperature has one")
        density, grid = on_one_grid(told_beside(density, found.warnings), found)
        if grid.ndim == 4 and grid.shape[3] != 3:
            raise SceneError(f"'{wanted}' has {grid.shape[3]} channels, colours have three")
        named: dict[str, Any] = {"temperature" if hot else "grid": grid}
        return Emission(radiance or WHITE, **named, **given), density


def on_one_grid(
    density: VolumeGrid, other: GridValues, *, grows: bool = True
) -> tuple[VolumeGrid, F32]:
    """Both on voxels of the density's size, over a box that holds both; 0 outside their own.

    Unless it `grows`, the density keeps its box.
    """
    own = GridBox(density.density.shape, density.bounds, density.world_from_volume)
    others = GridBox(other.values.shape[:3], other.bounds, other.world_from_volume)
    box = own.holding(others) if grows else own
    placed = box.values_of(other.values, others)
    if box is own:
        return density, placed
    grown = box.values_of(density.density, own)
    return replace(density, density=grown, bounds=box.bounds), placed


def told_beside(grid: VolumeGrid, others: Iterable[str]) -> VolumeGrid:
    """The grid with the warnings of another one beside it; what both say is said once."""
    more = tuple(text for text in others if text not in grid.warnings)
    return replace(grid, warnings=(*grid.warnings, *more)) if more else grid
