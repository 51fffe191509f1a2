"""Density grids: NumPy .npy and .npz, Mitsuba .vol, VDB, VTK .vti, NetCDF .nc and .zarr.

Every header is checked against the file's size before anything is allocated.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, nearest
from .. import checks
from ..checks import F32, F64, Bounds
from ..one_grid import LONGEST_SIDE
from .dense_grid import LARGEST_VALUE_COUNT, DenseGrid, Optics, warnings_of, without_missing
from .files import is_file, is_folder, naming
from .nanovdb import SparseGrid, read_nanovdb
from .netcdf import read_xarray, xarray_names
from .netcdf_opened import ZARR
from .numpy_files import opened_npz, read_npy
from .openvdb import openvdb_names, read_openvdb
from .vol import read_vol
from .vti import read_vti, vti_names

NOWHERE = "does not say where it is"
"""In the warning of a file without a box."""

UPRIGHT_SUFFIXES = (".nc", ".nc4", ZARR)
"""Of files whose own axes say which way is up: their grids are read with +Y up."""

_CHANNELS = {"density": 0, "r": 0, "g": 1, "b": 2, "a": 3}


@dataclass(frozen=True, eq=False)
class VolumeGrid:
    """A density grid as a file holds it.

    `density` is (z, y, x) float32; `bounds` the world box in metres that the file gives it, or a
    box 2 m along its longest side where the file gives none, which `warnings` then says.
    `world_from_volume` (4, 4) comes after the box, where the file turns it. `optics`: the medium
    that the file's units say it is. `time`: which of the file's times is shown, if it has several.
    `upright` as a DenseGrid has it.
    """

    density: F32
    bounds: Bounds
    warnings: tuple[str, ...] = ()
    world_from_volume: F64 = field(default_factory=lambda: np.eye(4))
    optics: Optics | None = None
    time: int | None = None
    upright: str = ""


def read_volume(
    path: str | Path, grid: str = "density", channels: str = "density", time: int | None = None
) -> VolumeGrid:
    """Read a density grid.

    `grid` names the array of an .npz or .vti, the grid of a VDB file or the variable of a NetCDF or
    zarr one; `channels` the channel that holds
    the density: "density" (the only one), "r", "g", "b" or "a". `time`: which of a file's times is
    shown, where `grid` has several and no number of its own. Arrays are (z, y, x) or
    (z, y, x, channel); an .npz may hold `bounds` (2, 3) in metres too. Raises SceneError for what
    cannot be read.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    with naming(path):
        # Sparse grids say where they are; of vectors one channel is the density.
        if suffix in _SPARSE:
            read, told = _sparse(path, grid)
            other = _other_name(path, grid, read.name)
            sparse = replace(_from_sparse(read), warnings=(*other, *told))
            if sparse.density.ndim == 4:
                sparse = replace(sparse, density=_density(sparse.density, channels))
            return _fitting(sparse, path)
        if suffix not in _DENSE:
            known = ", ".join((*_DENSE, *_SPARSE))
            raise SceneError("is not a density grid", remedy=f"Known endings: {known}.")
        # Dense ones are arrays; without a box of their own they get one.
        found = _dense(path, grid, time)
        density = _density(found.values, channels)
        placed = _in_own_box(density, path)
        if found.bounds is not None:
            placed = VolumeGrid(density, found.bounds, (), found.world_from_volume)
        named = _unnamed(path, grid)
        shown = found.time if time is None else time
        placed = replace(placed, optics=found.optics, time=shown, upright=found.upright)
        return _fitting(replace(placed, warnings=(*found.warnings, *placed.warnings, *named)), path)


@dataclass(frozen=True, eq=False)
class GridValues:
    """Any grid of a file: `values` (z, y, x) or (z, y, x, channel), placed as a VolumeGrid is."""

    values: F32
    bounds: Bounds
    world_from_volume: F64
    warnings: tuple[str, ...] = ()
    time: int | None = None


def read_values(path: Path, grid: str, time: int | None = None) -> GridValues:
    """The grid called `grid` of a file, of any channels and sign, at a `time` as `read_volume`.

    Raises SceneError.
    """
    with naming(path):
        suffix = path.suffix.lower()
        if suffix in _SPARSE:
            sparse, told = _sparse(path, grid)
            # A single grid is found by any name, so its own is checked here.
            if sparse.name not in ("", grid):
                raise SceneError(f"has no grid '{grid}', only '{sparse.name}'")
            found = _from_sparse(sparse)
            return GridValues(found.density, found.bounds, found.world_from_volume, told)
        if suffix not in _DENSE:
            known = ", ".join((*_DENSE, *_SPARSE))
            raise SceneError("is not a grid", remedy=f"Known endings: {known}.")
        dense = _dense(path, grid, time)
        values, bounds = dense.values, dense.bounds
        if values.ndim not in (3, 4) or values.dtype.kind not in "fiub":
            raise SceneError(f"'{grid}' is {values.dtype} {values.shape}, not numbers (z, y, x)")
        if values.size == 0:
            raise SceneError(f"'{grid}' is empty: its shape is {values.shape}")
        made = np.ascontiguousarray(values, np.float32)
        if bounds is None:
            bounds = _in_own_box(made, path).bounds
        shown = dense.time if time is None else time
        return GridValues(made, bounds, dense.world_from_volume, dense.warnings, shown)


def _dense(path: Path, grid: str, time: int | None) -> DenseGrid:
    suffix = path.suffix.lower()
    # Only files of simulations hold times.
    if suffix in UPRIGHT_SUFFIXES:
        return read_xarray(path, grid, time)
    found = _DENSE[suffix](path, grid)
    values, told = without_missing(found.values, grid, path.name)
    return replace(found, values=values, warnings=(*found.warnings, *told))


def _sparse(path: Path, grid: str) -> tuple[SparseGrid, tuple[str, ...]]:
    found = _SPARSE[path.suffix.lower()](path, grid)
    values, told = without_missing(found.values, found.name or grid, path.name)
    return replace(found, values=values), told


def grid_names(path: Path) -> list[str]:
    """The named grids of a file; none of files that hold but one. Raises SceneError."""
    with naming(path):
        names = _NAMES.get(path.suffix.lower())
        return names(path) if names else []


def is_grid_file(path: Path) -> bool:
    """Whether there is a file, or the folder that a zarr store is."""
    return is_file(path) or (path.suffix.lower() == ZARR and is_folder(path))


def _unnamed(path: Path, wanted: str) -> tuple[str, ...]:
    """A warning where a grid is asked for by name of a file whose only one has none."""
    if wanted == "density" or path.suffix.lower() in _NAMES:
        return ()
    return (f"{path.name}: its only grid has no name: grid '{wanted}' is left out",)


def _other_name(path: Path, wanted: str, name: str) -> tuple[str, ...]:
    """A warning where a file's only grid has another name than the one asked for."""
    if wanted in ("density", name):
        return ()
    return (f"{path.name}: its only grid is '{name}', not '{wanted}'",)


def _from_sparse(grid: SparseGrid) -> VolumeGrid:
    """Voxels at whole numbers; a level set as what it holds, its rim anti-aliased."""
    matrix = grid.world_from_index
    # Box faces lie half a voxel outside of the outermost centres.
    low = np.array(grid.first) - 0.5
    high = low + grid.values.shape[:3]
    values = grid.values
    # A level set holds distances: inside is 1, and the rim a voxel wide.
    if grid.is_level_set:
        voxel_m = float(np.cbrt(abs(np.linalg.det(matrix[:3, :3]))))
        values = np.clip(0.5 - values / np.float32(voxel_m), 0.0, 1.0)
    density = np.ascontiguousarray(np.moveaxis(values, (0, 1, 2), (2, 1, 0)), np.float32)
    # Without rotation a box says where it is, else a matrix.
    scale = np.diag(matrix[:3, :3])
    if np.array_equal(matrix[:3, :3], np.diag(scale)) and scale.min() > 0.0:
        low, high = (corner * scale + matrix[:3, 3] for corner in (low, high))
        return VolumeGrid(density, checks.bounds((low, high), "its box"))
    return VolumeGrid(density, checks.bounds((low, high), "its box"), (), matrix)


def _fitting(grid: VolumeGrid, path: Path) -> VolumeGrid:
    """Sides beyond what devices take averaged over whole numbers of voxels, and said so.

    Raises SceneError for values that are no densities.
    """
    density = grid.density
    warned = warnings_of(density, path)
    grid = replace(grid, warnings=(*grid.warnings, *warned)) if warned else grid
    # Means over runs of voxels, the last one of as many as there are.
    for axis, size in enumerate(density.shape):
        step = -(-size // LONGEST_SIDE)
        if step > 1:
            starts = np.arange(0, size, step)
            shape = [1, 1, 1]
            shape[axis] = -1
            held = np.diff(np.append(starts, size)).reshape(shape)
            sums = np.add.reduceat(density, starts, axis)
            density = (sums / held).astype(np.float32)
    if density is grid.density:
        return grid
    have, now = (" x ".join(str(n) for n in d.shape[::-1]) for d in (grid.density, density))
    text = f"{path.name} has {have} voxels, averaged to {now}: at most {LONGEST_SIDE} on a side"
    return replace(grid, density=density, warnings=(*grid.warnings, text))


def _density(values: NDArray[Any], channels: str) -> F32:
    """(z, y, x) float32 from (z, y, x) or (z, y, x, channel)."""
    if channels not in _CHANNELS:
        raise SceneError(f"channels = '{channels}' is unknown", remedy=nearest(channels, _CHANNELS))
    # A scalar grid is one of a single channel.
    if values.ndim == 3:
        values = values[..., None]
    if values.ndim != 4:
        raise SceneError(f"has shape {values.shape}, it must be (z, y, x) or (z, y, x, channel)")
    count, wanted = values.shape[3], _CHANNELS[channels]
    if channels == "density" and count != 1:
        raise SceneError(
            f"has {count} channels, which one is the density is not clear",
            remedy='Say channels = "r", "g", "b" or "a", or --channels.',
        )
    if wanted >= count:
        raise SceneError(f"has {count} channels, there is no channel '{channels}'")
    if values.dtype.kind not in "fiub":
        raise SceneError(f"holds {values.dtype} values, it must hold numbers")
    return cast(F32, np.ascontiguousarray(values[..., wanted], dtype=np.float32))


def _in_own_box(density: F32, path: Path) -> VolumeGrid:
    """Cubic voxels, 2 m along the longest side, centred at the origin."""
    size = density.shape[:3]
    half = np.array(size[::-1]) / max(size)
    x, y, z = (float(h) for h in half)
    text = f"{path.name} {NOWHERE}: it fills {2 * x:g} x {2 * y:g} x {2 * z:g} m "
    return VolumeGrid(density, ((-x, -y, -z), (x, y, z)), (text + "around the origin",))


def _read_npy(path: Path, grid: str) -> DenseGrid:
    return DenseGrid(read_npy(path, most_values=LARGEST_VALUE_COUNT))


def _npz_names(path: Path) -> list[str]:
    with opened_npz(path) as archive:
        return list(archive.names)


def _read_npz(path: Path, grid: str) -> DenseGrid:
    with opened_npz(path) as archive:
        # The box first: a grid may be large, and a bad box would make it useless.
        bounds = None
        if "bounds" in archive.names and grid != "bounds":
            bounds = checks.bounds(archive.array("bounds"), "its array 'bounds'")
        return DenseGrid(archive.array(grid, most_values=LARGEST_VALUE_COUNT), bounds)


_DENSE = {
    ".npy": _read_npy,
    ".npz": _read_npz,
    ".vol": read_vol,
    ".vti": read_vti,
    **dict.fromkeys(UPRIGHT_SUFFIXES, read_xarray),
}
_SPARSE = {".nvdb": read_nanovdb, ".vdb": read_openvdb}
_NAMES = {
    ".npz": _npz_names,
    ".vdb": openvdb_names,
    ".vti": vti_names,
    **dict.fromkeys(UPRIGHT_SUFFIXES, xarray_names),
}
