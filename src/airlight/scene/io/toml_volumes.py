"""[[volume]] tables: a density grid's file, a sequence of them, or a shape."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError
from ..animation.file_sequence import FileSequence
from ..checks import F64, Bounds, Rgb
from ..medium import extinction_and_albedo
from ..volume import Volume
from .coefficient_files import NAMES, density_or_first, read_coefficients, taken_grids
from .emission_files import taken_emission
from .files import named_file
from .grid_times import Times, frames_of, in_time
from .ledger import note_read
from .toml_animation import file_sequence, volume_files
from .toml_keys import SEQUENCE_KEYS
from .toml_media_tables import VOLUME
from .toml_meshes import existing_file, upright_from_file, world_from_mesh
from .toml_schema import check_table, inside
from .toml_volume_shapes import shape_volume
from .upright import upright_from_grid
from .volumes import NOWHERE, VolumeGrid, is_grid_file

_PLACING = ("translate", "rotate_deg", "scale", "matrix")
_OF_FILES = ("grid", "channels")


def placed_volume(
    raw: Any, label: str, folder: Path
) -> tuple[Volume, tuple[str, ...], FileSequence | None]:
    """The volume, what its file left open, and the sequence that it is the first file of."""
    values = check_table(VOLUME, raw, label)
    with inside(label):
        grids = taken_grids(values)
    given = dict(values)
    values = with_extinction(values, label)
    # Where densities come from: a file, a sequence of files, or a shape.
    if sum(name in values for name in ("file", "shape", "sequence")) != 1:
        raise SceneError(f"{label} needs either a file, a sequence or a shape")
    if "sequence" not in values:
        for key in SEQUENCE_KEYS:
            if key.name in values:
                raise SceneError(f"{label}: {key.name} belongs to a sequence")
    matrix = world_from_mesh(values, label)
    turn = {"up": values.pop("up")} if "up" in values else {}
    values = {name: value for name, value in values.items() if name not in _PLACING}
    # A shape is complete here: it has no file to be read and no times.
    if "shape" in values:
        of_files = [name for name in _OF_FILES if name in values]
        for name in (*of_files, *(f"{n}_grid" for n in grids)):
            raise SceneError(f"{label}: {name} belongs to a file, not to a shape")
        return *shape_volume(values, matrix, upright_from_file(turn), label, folder), None
    # The first file with anything in it stands for all: it says where the volume lies.
    is_file = "file" in values
    written = values.pop("file" if is_file else "sequence")
    files = (
        (_grid_file(written, label, folder),) if is_file else volume_files(written, folder, label)
    )
    note_read(*files)  # of a sequence those that are read later, too
    times: Times = (None,)
    glowing = values.get("emission_grid", values.get("temperature_grid"))
    ordered: tuple[str, ...] = ()
    if not is_file:
        files, _, ordered = in_time(files)
        files, times = frames_of(files, values.get("grid", "density"), grids, glowing)
    first, grid = _first_filled(files, times, values, grids)
    # Emission and coefficients, of that time, may need a larger box than the density's.
    with inside(label):
        emission, grown = taken_emission(values, files[first], grid)
        grid = grown or grid
        if grids:
            values, grid = _with_coefficients(values, given, files[first], grid, grids)
    # Into the world: upright first, as the file has its axes, then where the table places it.
    sequence = file_sequence(values, files, times, grid, glowing, grids)
    upright, told = upright_from_grid(turn, grid, files[first])
    values, warnings = _in_its_box(values, grid, matrix @ upright, upright)
    with inside(label):
        volume = Volume(density=grid.density, source=written, emission=emission, **values)
        if first:  # a sequence may begin empty
            volume = sequence.of(volume, sequence.start_s)
    return volume, (*ordered, *told, *warnings), None if is_file else sequence


def _in_its_box(
    values: dict[str, Any], grid: VolumeGrid, matrix: F64, upright: F64
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """The values with the box and the matrix of a grid that `matrix` moves, and what is said."""
    if "bounds" not in values:
        placed = matrix @ grid.world_from_volume
        return {**values, "bounds": grid.bounds, "world_from_volume": placed}, grid.warnings
    # The box is the world's, so that it holds once the grid is upright.
    box = _before(values["bounds"], upright)
    told = tuple(text for text in grid.warnings if NOWHERE not in text)
    return {**values, "bounds": box, "world_from_volume": matrix}, told


def _before(box: Bounds, turn: F64) -> Bounds:
    """The box that a turn by right angles makes `box`."""
    corners = np.array(box) @ turn[:3, :3]  # the inverse, as of rows
    (x, y, z), (u, v, w) = corners.min(axis=0), corners.max(axis=0)
    return (float(x), float(y), float(z)), (float(u), float(v), float(w))


def _first_filled(
    files: tuple[Path, ...], times: Times, values: dict[str, Any], grids: dict[str, str]
) -> tuple[int, VolumeGrid]:
    """The number of the file that says how large a volume is and where it lies, and its grid.

    `times`: which of its times it is. That is the first one that holds any density, or the first of
    all where none does. Warnings of the first of all are among the grid's.
    """
    name, channels = (values.get(key, "density") for key in _OF_FILES)
    first: VolumeGrid | None = None
    for k, (path, time) in enumerate(zip(files, times, strict=True)):
        grid = density_or_first(path, name, channels, grids, time)
        first = first or grid
        if grid.density.any():
            more = tuple(text for text in first.warnings if text not in grid.warnings)
            return k, replace(grid, warnings=(*more, *grid.warnings))
    if first is None:
        raise SceneError(f"has no times of '{name}' yet")
    return 0, first


def _grid_file(written: str, label: str, folder: Path) -> Path:
    """A grid's file, or the folder that a zarr store is. Raises SceneError."""
    path = named_file(written, "", folder)
    return path if is_grid_file(path) else existing_file(written, label, folder)


def _with_coefficients(
    values: dict[str, Any],
    given: dict[str, Any],
    path: Path,
    grid: VolumeGrid,
    grids: dict[str, str],
) -> tuple[dict[str, Any], VolumeGrid]:
    """The values with coefficients by voxel, and the density on the box that holds their grids."""
    grid, made = read_coefficients(path, grid, grids, {n: given[n] for n in NAMES if n in given})
    # A sequence mixes densities, so only colours that leave the density alone will do.
    if "sequence" in given and "sigma_t" in made:
        raise SceneError(f"{next(iter(grids))}_grid belongs to a file, not to a sequence")
    # Grids of extinction have the table's numbers in them already.
    if "sigma_t" in made:
        values = {name: value for name, value in values.items() if name not in NAMES}
    return {**values, **made}, grid


def with_extinction(values: dict[str, Any], label: str) -> dict[str, Any]:
    """The values with sigma_s and sigma_a turned into sigma_t and albedo."""
    # One pair of coefficients or the other, not a mixture of both.
    scattering = [name for name in ("sigma_s", "sigma_a") if name in values]
    extinction = [name for name in ("sigma_t", "albedo") if name in values]
    remedy = "Use sigma_t and albedo, or sigma_s and sigma_a."
    if scattering and extinction:
        raise SceneError(f"{label} mixes {scattering[0]} with {extinction[0]}", remedy=remedy)
    if not scattering and "sigma_t" not in values:
        raise SceneError(f"{label} has no sigma_t", remedy=remedy)
    if not scattering:
        return values
    nothing: Rgb = (0.0, 0.0, 0.0)
    pair = (values.pop("sigma_s", nothing), values.pop("sigma_a", nothing))
    sigma_t, albedo = extinction_and_albedo(*pair)
    return {**values, "sigma_t": sigma_t, "albedo": albedo}
