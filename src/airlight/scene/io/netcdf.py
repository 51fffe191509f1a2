"""NetCDF files and zarr folders by xarray: clouds and plumes of simulations.

The extra `science` brings xarray, with h5netcdf for NetCDF 4, SciPy for NetCDF 3, and zarr. Axes
and units are the file's own (`gridded`); water contents become extinction.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import AirlightError, SceneError
from ..checks import F64
from .cloud_water import as_opaque, is_length, optical, radius_of
from .dense_grid import DenseGrid, check_count, chosen_name
from .files import inside, is_folder, opened, regular_file
from .gridded import Axis, letter_of, placed
from .ledger import note_read
from .netcdf_times import at_one_time, name_and_number

ZARR = ".zarr"
_GET = "Run: pip install 'airlight[science]'."
_MOST_PARTS = 1 << 20
_LIKELY: tuple[str, ...] = (
    "density",
    "extinction",
    "qc",
    "ql",
    "QC",
    "QCLOUD",
    "clw",
    "lwc",
    "LWC",
    "q_liquid",
)
_LIKELY += ("cloud_water", "rcloud", "QN", "smoke", "soot")

_GRAVITY = 9.81  # m s^-2, as WRF has it


def read_xarray(path: Path, wanted: str) -> DenseGrid:
    """The variable called `wanted`; of "density", the only one or the likeliest cloud.

    "NAME[3]" is its fourth time; else, of several, the first that holds any is read. Raises
    SceneError for what is damaged or has no such variable or time, and where the extra is not
    installed.
    """
    # All is read while the file is open: xarray loads values when they are asked for.
    with _opened(path) as dataset:
        names = _names(dataset)
        asked, number = name_and_number(wanted, names)
        name = chosen_name(asked, names, _LIKELY)
        warned = () if name == asked else (f"{path.name}: its variable '{name}' is the density",)
        lines = _wrf_lines(dataset)
        time = _time_axis(dataset[name], lines)
        variable, number, timed = at_one_time(dataset[name], time, number, path.name)
        values, axes, told = _along_axes(variable, lines, path.name)
        values, sized, radius = _sized(dataset, dataset[name], time, number, values, path.name)
        made = placed(values, axes, path.name)
        units = str(dataset[name].attrs.get("units", "")).strip()
        told = (*warned, *timed, *told, *sized, *made.warnings)
    # The units decide how values become extinction: mixing ratios need the air's density at their
    # height.
    density, optics = optical(made.values, made.heights_m, units, radius)
    density, mended = _mended(density, path.name)
    return DenseGrid(density, made.box, warnings=(*told, *mended), optics=optics)


def xarray_names(path: Path) -> list[str]:
    """The variables of three dimensions or more. Raises SceneError."""
    with _opened(path) as dataset:
        return _names(dataset)


def _names(dataset: Any) -> list[str]:
    # Numbers along three axes at least that have more than one cell.
    return [
        str(name)
        for name, variable in dataset.data_vars.items()
        if sum(n > 1 for n in variable.shape) >= 3 and variable.dtype.kind in "fiub"
    ]


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The dataset, its values still in the file. Raises SceneError."""
    engine = _engine(path)
    try:
        import xarray
    except ImportError:
        raise _missing("xarray") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of attributes that are not as the conventions say
            # Times stay numbers: only one is read.
            with xarray.open_dataset(
                path, engine=engine, decode_times=False, cache=False
            ) as dataset:
                yield dataset
    except AirlightError:
        raise
    except ImportError as error:
        raise _missing(engine) from error
    except ValueError as error:
        if "unrecognized engine" in str(error):
            raise _missing(engine) from error
        raise _unreadable(error) from error
    except Exception as error:  # each of the libraries has its own
        raise _unreadable(error) from error


def _missing(package: str) -> SceneError:
    return SceneError(f"needs the package {package}, which is not installed", remedy=_GET)


def _unreadable(error: Exception) -> SceneError:
    text = " ".join(str(error).split())[:200]
    return SceneError(f"is not readable ({type(error).__name__}: {text})", remedy="Write it again.")


def _engine(path: Path) -> str:
    """xarray's name of what reads the file, which names nothing outside of itself."""
    if path.suffix.lower() == ZARR:
        _check_folder(path)
        return "zarr"
    with opened(path) as stream:
        start = stream.read(8)
    if start.startswith(b"CDF"):
        return "scipy"
    if start != b"\x89HDF\r\n\x1a\n":
        raise SceneError("is no NetCDF: it begins neither as NetCDF 3 nor as HDF5")
    _check_hdf5(path)
    return "h5netcdf"


def _check_folder(path: Path) -> None:
    """Raise SceneError for what is no folder of regular files, or has links out of it."""
    note_read(path)
    if not is_folder(path):
        regular_file(path)
        raise SceneError("is no zarr folder", remedy="Unpack it: a zarr store is a folder here.")
    count = 0
    # Reading a store opens any of its files, so none of them may lead out of it.
    for folder, _, files in os.walk(path):
        count += len(files)
        if count > _MOST_PARTS:
            raise SceneError(f"has over {_MOST_PARTS:,} files", remedy="Write larger chunks.")
        for name in files:
            part = Path(folder, name)
            if part.is_symlink():
                inside(path, str(part.relative_to(path)), path)
            if not part.is_file():
                raise SceneError(f"holds '{name}', which is no file")


def _check_hdf5(path: Path) -> None:
    """Raise SceneError where links or data of an HDF5 file lie in other files."""
    try:
        import h5py
    except ImportError:
        raise _missing("h5netcdf") from None
    outside = SceneError("has data in other files, which are not followed", remedy="Repack it.")

    # External links and virtual datasets would read files that nobody named.
    def look(group: Any, depth: int) -> None:
        for name in group:
            link = group.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise outside
            # Soft links lead to what the file holds, under its own name.
            if not isinstance(link, h5py.HardLink):
                continue
            found = group[name]
            if isinstance(found, h5py.Dataset) and (found.external or found.is_virtual):
                raise outside
            if isinstance(found, h5py.Group) and depth < 32:
                look(found, depth + 1)

    try:
        with h5py.File(path, "r") as file:
            look(file, 0)
    except AirlightError:
        raise
    except Exception as error:
        raise _unreadable(error) from error


def _wrf_lines(dataset: Any) -> dict[str, F64]:
    """Centres of cells, m, in files of the model WRF, which has them as attributes and potentials.

    Heights are those of the geopotential's mean over each level.
    """
    lines = {}
    for name, key in (("west_east", "DX"), ("south_north", "DY")):
        if key in dataset.attrs and name in dataset.sizes:
            lines[name] = (np.arange(dataset.sizes[name]) + 0.5) * float(dataset.attrs[key])
    if "PH" in dataset and "PHB" in dataset and "bottom_top_stag" in dataset["PH"].dims:
        whole = (dataset["PH"] + dataset["PHB"]).isel(Time=0) / _GRAVITY
        # Levels lie between the edges of a staggered grid.
        edges = np.asarray(whole.mean(("south_north", "west_east")).values, np.float64)
        lines["bottom_top"] = 0.5 * (edges[1:] + edges[:-1])
    return lines


def _along_axes(
    variable: Any, lines: dict[str, F64], file: str
) -> tuple[NDArray[Any], list[Axis], tuple[str, ...]]:
    """Values along Z, Y and X, their axes, and what was left out. Raises SceneError.

    `lines` has coordinates in metres of dimensions without any.
    """
    axes = [_axis(variable, str(name), lines) for name in variable.dims]
    told: list[str] = []
    kept: list[Axis] = []
    # Dimensions of one cell are dropped where there are more than three.
    for k, axis in enumerate(axes):
        if axis.size == 1 and len(kept) + len(axes) - k > 3:
            variable = variable.isel({axis.name: 0})
        else:
            kept.append(axis)
    check_count(variable.size)
    if len(kept) != 3:
        have = " x ".join(f"{axis.name} ({axis.size})" for axis in kept)
        raise SceneError(f"its variable '{variable.name}' has the dimensions {have}, not three")
    # Axes that do not say which they are count as height, y, x.
    if sorted(axis.letter for axis in kept) != ["X", "Y", "Z"]:
        kept = [replace(axis, letter=letter) for axis, letter in zip(kept, "ZYX", strict=True)]
        names = ", ".join(axis.name for axis in kept)
        told.append(f"{file} does not say which way its axes go: {names} are height, y, x")
    # Height first, as grids of the world come here.
    order = [next(a for a in kept if a.letter == letter) for letter in "ZYX"]
    values = variable.transpose(*(axis.name for axis in order)).values
    return values, order, tuple(told)


def _sized(
    dataset: Any, water: Any, time: str | None, number: int, values: NDArray[Any], file: str
) -> tuple[NDArray[Any], tuple[str, ...], str]:
    """Water as opaque as in droplets of the radius that the file has, what to tell, its name.

    Small droplets are more opaque; radii are used before levels are resampled.
    """
    radius = radius_of(water, dataset)
    if radius is None:
        return values, (), ""
    name, units = str(radius.name), radius.attrs.get("units", "")
    if not is_length(radius):
        text = f"{file}: '{name}' is no radius of droplets: its units '{units}' are no length"
        return values, (text,), ""
    at = radius if time is None else radius.isel({time: number})
    sizes, _, _ = _along_axes(at, _wrf_lines(dataset), file)
    return as_opaque(values, sizes, radius), (f"{file}: '{name}' is the droplets' radius",), name


def _time_axis(variable: Any, lines: dict[str, F64]) -> str | None:
    """The dimension of times, of a variable of more than three dimensions."""
    axes = [_axis(variable, str(name), lines) for name in variable.dims]
    return next((a.name for a in axes if a.letter == "T" and len(axes) > 3), None)


def _axis(variable: Any, name: str, lines: dict[str, F64]) -> Axis:
    size = int(variable.sizes[name])
    centres, attributes = lines.get(name), {"units": "m"} if name in lines else {}
    # Coordinates of the dimension itself win over those from WRF's attributes.
    if name in variable.coords and variable.coords[name].ndim == 1:
        found = variable.coords[name]
        if found.dtype.kind in "fiu":
            centres, attributes = np.asarray(found.values, np.float64), dict(found.attrs)
    letter = letter_of(name, attributes)
    is_down = str(attributes.get("positive", "up")).lower() == "down"
    return Axis(name, letter, size, centres, str(attributes.get("units", "")), is_down)


def _mended(values: NDArray[np.float32], file: str) -> tuple[NDArray[np.float32], tuple[str, ...]]:
    """Missing values as none, and what rounding left below 0."""
    told = []
    missing = int(np.isnan(values).sum())
    if missing:
        values = np.nan_to_num(values, nan=0.0, posinf=np.inf, neginf=-np.inf)
        told.append(f"{file} has {missing:,} missing values, taken as 0")
    least, most = float(values.min(initial=0.0)), float(values.max(initial=0.0))
    # Values a little below 0 are what rounding leaves, no mistake of the file.
    if 0.0 > least >= -1e-3 * most:
        values = np.maximum(values, np.float32(0.0))
        told.append(f"{file} has values of rounding below 0, taken as 0")
    return values, tuple(told)
