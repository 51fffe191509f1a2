"""Where the cells of a NetCDF or zarr variable are along each of its dimensions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..checks import F64
from .netcdf_axes import SEA_LEVEL_PA, Axis, is_downwards, is_measured, letter_of

_STRAIGHT = 0.01  # of a coordinate's span: it may change by that along another dimension


@dataclass(frozen=True, eq=False)
class _Line:
    """Numbers along a dimension, what they are called, their attributes, and what is doubtful."""

    centres: F64
    name: str
    attributes: dict[str, Any] = field(default_factory=dict)
    doubt: str = ""


def axis_of(variable: Any, name: str, lines: dict[str, F64]) -> Axis:
    """The dimension `name` of a variable; `lines` has coordinates in metres of those without any.

    Coordinates of the file win: the dimension's own, those beside it that say more, as heights of
    numbered levels do, and those of two dimensions, as maps of latitudes have them.
    """
    found = _own_or_beside(variable, name)
    if found is None and name in lines:
        found = _Line(lines[name], name, {"units": "m"})
    found = found or _across(variable, name)
    size = int(variable.sizes[name])
    if found is None:
        return Axis(name, letter_of(name, {}), size, None, "")
    letter = letter_of(found.name, found.attributes)
    is_down = is_downwards(found.name, found.attributes, found.centres)
    units = str(found.attributes.get("units", ""))
    if _is_sigma(found):
        return Axis(name, "Z", size, found.centres * SEA_LEVEL_PA, "Pa", doubt=found.doubt)
    return Axis(name, letter, size, found.centres, units, is_down, found.doubt)


def _is_sigma(line: _Line) -> bool:
    """Whether numbers are shares of the pressure at the ground, as levels of models are."""
    said = str(line.attributes.get("standard_name", ""))
    is_named = line.name.lower() == "sigma" or ("atmosphere" in said and "sigma" in said)
    return is_named and 0.0 < float(line.centres.min()) <= float(line.centres.max()) <= 1.1


def _own_or_beside(variable: Any, name: str) -> _Line | None:
    along = [c for c in variable.coords.values() if c.dims == (name,) and c.dtype.kind in "fiu"]
    own = [c for c in along if str(c.name) == name]
    if own and (is_measured(own[0].attrs) or letter_of(name, dict(own[0].attrs)) == "T"):
        return _line(own[0])
    # What lies beside it has to say which way it goes.
    beside = [c for c in along if letter_of(str(c.name), dict(c.attrs)) in ("X", "Y", "Z")]
    best = next(iter((*(c for c in beside if is_measured(c.attrs)), *own, *beside)), None)
    return None if best is None else _line(best)


def _line(coordinate: Any) -> _Line:
    values = np.asarray(coordinate.values, np.float64)
    return _Line(values, str(coordinate.name), dict(coordinate.attrs))


def _across(variable: Any, name: str) -> _Line | None:
    """The mean along a dimension of a coordinate of two that changes most along this one."""
    best, most = None, 0.5
    for coordinate in variable.coords.values():
        letter = letter_of(str(coordinate.name), dict(coordinate.attrs))
        if coordinate.ndim != 2 or name not in coordinate.dims or letter not in ("X", "Y"):
            continue
        if coordinate.dtype.kind not in "fiu" or not is_measured(coordinate.attrs):
            continue
        values = np.asarray(coordinate.transpose(name, ...).values, np.float64)
        line = values.mean(axis=1)
        # How much it changes along this dimension, and along the other one.
        span, other = float(np.ptp(line)), float(np.ptp(values, axis=1).mean())
        share = span / max(span + other, 1e-300)
        if share > most and values.shape[1] > 1:
            bent = other > _STRAIGHT * span
            doubt = f"'{coordinate.name}' is curved, and taken as straight along '{name}'"
            best = _Line(line, str(coordinate.name), dict(coordinate.attrs), doubt if bent else "")
            most = share
    return best
