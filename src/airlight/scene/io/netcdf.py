"""NetCDF files and zarr folders by xarray: clouds and plumes of simulations.

The extra `science` brings xarray, with h5netcdf for NetCDF 4, SciPy for NetCDF 3, and zarr. Axes
and units are the file's own (`gridded`); water contents become extinction.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import F64
from .cloud_water import as_opaque, is_length, optical, radius_of
from .dense_grid import DenseGrid, check_count, chosen_name, without_missing
from .gridded import placed
from .netcdf_axes import Axis, lettered
from .netcdf_coordinates import axis_of
from .netcdf_opened import opened_dataset
from .netcdf_times import at_one_time, name_and_number

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
_IN_SPACE = "A density has numbers along height, y and x, more than one along each."
_NEVER_WRITTEN = np.float32(9.9692099683868690e36)  # NC_FILL_FLOAT and NC_FILL_DOUBLE
_CELSIUS: tuple[str, ...] = ("degc", "deg_c", "celsius", "°c", "degree_c", "degrees_c")
_CELSIUS += ("degree_celsius", "degrees_celsius", "degrees celsius")
_LIKELY += ("cloud_water", "rcloud", "QN", "smoke", "soot")


def read_xarray(path: Path, wanted: str, shown: int | None = None) -> DenseGrid:
    """The variable called `wanted`; of "density", the only one or the likeliest cloud.

    "NAME[3]" is its fourth time; else, of several, the one that is `shown`, or of None the first
    that holds any. Raises SceneError for what is damaged or has no such variable or time, and where
    the extra is not installed.
    """
    # All is read while the file is open: xarray loads values when they are asked for.
    with opened_dataset(path) as dataset:
        asked, number = name_and_number(wanted, _names(dataset))
        name = _chosen(dataset, asked)
        warned = () if name == asked else (f"{path.name}: its variable '{name}' is the density",)
        time = _time_axis(dataset[name])
        count = _count(dataset[name])
        variable, number, timed = at_one_time(dataset[name], time, number, shown, path.name)
        lines = wrf_lines(dataset, time, number)
        values, axes, upright, told = _along_axes(variable, lines, path.name)
        values, told_k = _kelvin(values, dataset[name], path.name)
        values, sized, radius = _sized(dataset, dataset[name], time, number, values, path.name)
        made = placed(values, axes, path.name)
        units = str(dataset[name].attrs.get("units", "")).strip()
        told = (*warned, *timed, *told, *told_k, *sized, *made.warnings)
    # The units decide how values become extinction: mixing ratios need the air's density at their
    # height.
    density, optics = optical(made.values, made.heights_m, units, radius)
    density, mended = _mended(density, name, path.name)
    at = number if count > 1 else None
    told = (*told, *mended)
    return DenseGrid(density, made.box, warnings=told, optics=optics, time=at, upright=upright)


def xarray_names(path: Path) -> list[str]:
    """The variables of three dimensions or more, times apart. Raises SceneError."""
    with opened_dataset(path) as dataset:
        return _names(dataset)


def time_counts(path: Path) -> dict[str, int]:
    """How many times each of `xarray_names` has; 1 of those that are static. Raises SceneError."""
    with opened_dataset(path) as dataset:
        return {name: _count(dataset[name]) for name in _names(dataset)}


def time_axes(path: Path) -> list[tuple[str, str, list[float], list[str]]]:
    """Of each axis of times its name, units and values, and the grids that have several along it.

    An axis without values has none. Raises SceneError.
    """
    found: dict[str, list[str]] = {}
    with opened_dataset(path) as dataset:
        for name in _names(dataset):
            axis = _time_axis(dataset[name])
            if axis is not None and _count(dataset[name]) > 1:
                found.setdefault(axis, []).append(name)
        return [(axis, *_told(dataset.get(axis)), names) for axis, names in found.items()]


def _told(times: Any) -> tuple[str, list[float]]:
    """The units and the values of a coordinate, where those are numbers."""
    if times is None or times.ndim != 1 or times.dtype.kind not in "fiu":
        return "", []
    return str(times.attrs.get("units", "")), np.asarray(times.values, np.float64).tolist()


def likeliest(wanted: str, names: list[str]) -> str:
    """The variable of `names` that is read as `wanted`. Raises SceneError."""
    return chosen_name(wanted, names, _LIKELY)


def _count(variable: Any) -> int:
    time = _time_axis(variable)
    return 1 if time is None else int(variable.sizes[time])


def _names(dataset: Any) -> list[str]:
    # Numbers along three axes at least that have more than one cell; times are no direction.
    return [
        str(name)
        for name, variable in _fields(dataset).items()
        if _directions(variable) >= 3 and variable.dtype.kind in "fiub"
    ]


def _fields(dataset: Any) -> dict[Any, Any]:
    """The variables by name, without those that say where the corners of cells are."""
    corners = {variable.attrs.get("bounds") for variable in dataset.variables.values()}
    return {name: found for name, found in dataset.data_vars.items() if name not in corners}


def _directions(variable: Any) -> int:
    axes = (axis_of(variable, str(name), {}) for name in variable.dims)
    return sum(axis.size > 1 and axis.letter != "T" for axis in axes)


def _chosen(dataset: Any, wanted: str) -> str:
    """The variable called `wanted`, or the likeliest. Raises SceneError."""
    names = _names(dataset)
    # A flat field is named with its dimensions: maps of clouds hold no heights.
    flat = dataset.data_vars.get(wanted)
    if flat is None and not names:
        flat = max(_fields(dataset).values(), key=lambda v: (v.ndim, v.size), default=None)
    if wanted not in names and flat is not None and flat.dtype.kind not in "fiub":
        remedy = f"Grids: {', '.join(names[:20])}." if names else _IN_SPACE
        raise SceneError(f"its variable '{flat.name}' holds no numbers", remedy=remedy)
    if wanted not in names and flat is not None and flat.ndim > 0:
        axes = (axis_of(flat, str(name), {}) for name in flat.dims)
        along = " x ".join(
            f"{axis.name} ({axis.size}{' times' if axis.letter == 'T' else ''})" for axis in axes
        )
        raise SceneError(
            f"holds no grid of three dimensions in '{flat.name}': that is {along}",
            remedy=f"Grids in space: {', '.join(names[:20])}." if names else _IN_SPACE,
        )
    return likeliest(wanted, names)


def _along_axes(
    variable: Any, lines: dict[str, F64], file: str
) -> tuple[NDArray[Any], list[Axis], str, tuple[str, ...]]:
    """Values along Z, Y and X, and `lettered` axes. Raises SceneError.

    `lines` has coordinates in metres of dimensions without any.
    """
    axes = [axis_of(variable, str(name), lines) for name in variable.dims]
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
        odd = next((axis.name for axis in kept if not axis.letter), kept[-1].name)
        raise SceneError(
            f"its variable '{variable.name}' has the dimensions {have}, not three",
            remedy=f"Write one of '{odd}' into a file of its own: xarray's isel({odd}=0).",
        )
    order, upright, told = lettered(kept, file)
    values = variable.transpose(*(axis.name for axis in order)).values
    return values, order, upright, told


def _kelvin(values: NDArray[Any], variable: Any, file: str) -> tuple[NDArray[Any], tuple[str, ...]]:
    """Temperatures in kelvin, where their units are degrees Celsius; and what to tell."""
    units = str(variable.attrs.get("units", "")).strip()
    if units.lower() not in _CELSIUS:
        return values, ()
    text = f"{file}: '{variable.name}' is in {units}, and read in kelvin"
    return np.asarray(values, np.float32) + np.float32(273.15), (text,)


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
    sizes, *_ = _along_axes(at, wrf_lines(dataset, time, number), file)
    return as_opaque(values, sizes, radius), (f"{file}: '{name}' is the droplets' radius",), name


def _time_axis(variable: Any) -> str | None:
    """The dimension of times, if there is one."""
    axes = (axis_of(variable, str(name), {}) for name in variable.dims)
    return next((axis.name for axis in axes if axis.letter == "T"), None)


def _mended(
    values: NDArray[np.float32], name: str, file: str
) -> tuple[NDArray[np.float32], tuple[str, ...]]:
    """Missing values as none, and what rounding left below 0."""
    # What was never written holds a number of its own, that xarray takes for a value.
    never = values == _NEVER_WRITTEN
    values = np.where(never, np.float32(np.nan), values) if never.any() else values
    values, told = without_missing(values, name, file)
    least, most = float(values.min(initial=0.0)), float(values.max(initial=0.0))
    # Values a little below 0 are what rounding leaves, no mistake of the file.
    if 0.0 > least >= -1e-3 * most:
        values = np.maximum(values, np.float32(0.0))
        told = (*told, f"{file}: '{name}' has values of rounding below 0, taken as 0")
    return values, told


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
