"""Which way the dimensions of a NetCDF or zarr file go.

Conventions: CF (axis, standard_name, units, positive), and the names that models use.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, replace
from typing import Any

from ..checks import F64
from .dense_grid import SAID, TAKEN

_PREFIXES = {"": 1.0, "kilo": 1e3, "centi": 0.01, "milli": 1e-3, "micro": 1e-6, "nano": 1e-9}
_METRES = {f"{name}{end}": by for name, by in _PREFIXES.items() for end in ("metre", "meter")}
_METRES |= {"m": 1.0, "km": 1e3, "cm": 0.01, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6}
_METRES |= {"micron": 1e-6, "nm": 1e-9, "angstrom": 1e-10, "ft": 0.3048, "foot": 0.3048}
_METRES |= {"feet": 0.3048}
_PASCALS = {"pa": 1.0, "pascal": 1.0, "hpa": 100.0, "hectopascal": 100.0, "kpa": 1e3}
_PASCALS |= {"mb": 100.0, "mbar": 100.0, "millibar": 100.0}
SEA_LEVEL_PA = 101_325.0
_STANDARD = {
    "X": ("projection_x_coordinate", "longitude", "grid_longitude"),
    "Y": ("projection_y_coordinate", "latitude", "grid_latitude"),
    "Z": ("air_pressure", "model_level_number"),
    "T": ("time", "forecast_reference_time"),
}
_UPWARDS = re.compile(r"height|altitude|depth|atmosphere_\w*coordinate|ocean_\w*coordinate")
"""In the standard name of a vertical coordinate."""
_NAMED = (
    (
        "T",
        re.compile(r"^((\w*_)?time|n?t$|date|xtime|steps?$|frames?$|year|month|day|hour)", re.I),
    ),
    ("X", re.compile(r"^(x|lon|west_east|east|ni$|i$|nx)", re.I)),
    ("Y", re.compile(r"^(y|lat|south_north|north|nj$|j$|ny)", re.I)),
    (
        "Z",
        re.compile(
            r"^(z|(\w*_)?lev|height|alt|bottom_top|depth|pfull|plev|pressure|isobaric|k$|nz|hgt|"
            r"sigma|eta$|vertical|layer)",
            re.I,
        ),
    ),
)
_OF_TIME = ("s", "sec", "second", "min", "minute", "h", "hr", "hour", "day")
_CALLED = {"Z": "height", "Y": "y", "X": "x"}


@dataclass(frozen=True, eq=False)
class Axis:
    """A dimension: `letter` X, Y, Z or T ("" unknown), its cells' centres in units of the file.

    `doubt`: what to tell of them, if anything.
    """

    name: str
    letter: str
    size: int
    centres: F64 | None
    units: str
    is_down: bool = False
    doubt: str = ""


def metres_of(units: str) -> float | None:
    """How many metres a unit of length is; None of others."""
    return _known(units, _METRES)


def pascals_of(units: str) -> float | None:
    """How many pascals a unit of pressure is; None of others."""
    return _known(units, _PASCALS)


def _known(units: str, known: dict[str, float]) -> float | None:
    """In the singular or the plural, in capitals or not."""
    text = units.strip().lower().rstrip(".")
    return known.get(text, known.get(text.rstrip("s")))


def letter_of(name: str, attributes: dict[str, Any]) -> str:
    """Which way a dimension goes by its coordinate's attributes, else by its name; "" unknown."""
    # By the conventions' attributes, then by units, then by the name alone.
    axis = str(attributes.get("axis", "")).upper()
    if axis in _STANDARD:
        return axis
    said = str(attributes.get("standard_name", ""))
    units = str(attributes.get("units", "")).strip().lower()
    for letter, names in _STANDARD.items():
        if said in names:
            return letter
    # Only vertical coordinates have a positive direction.
    if _UPWARDS.search(said) or str(attributes.get("positive", "")).lower() in ("up", "down"):
        return "Z"
    # Units tell times, degrees and pressures apart.
    if " since " in units:
        return "T"
    if units.startswith(("degree_e", "degrees_e")):
        return "X"
    if units.startswith(("degree_n", "degrees_n")):
        return "Y"
    if pascals_of(units):
        return "Z"
    named = next((letter for letter, like in _NAMED if like.match(name)), "")
    # Seconds alone say it of an axis without a name: soundings have heights in them.
    is_time = units in _OF_TIME or units.rstrip("s") in _OF_TIME
    return named or ("T" if is_time else "")


def lettered(axes: list[Axis], file: str) -> tuple[list[Axis], str, tuple[str, ...]]:
    """Three axes as Z, Y and X, each with its letter; whether height is SAID or TAKEN; and doubts.

    What axes say of themselves holds; those that say nothing, or the same as another one, get the
    letters that are left, as height, y, x.
    """
    counts = Counter(axis.letter for axis in axes)
    is_known = [axis.letter in ("Z", "Y", "X") and counts[axis.letter] == 1 for axis in axes]
    known = [axis.letter for axis, is_said in zip(axes, is_known, strict=True) if is_said]
    left = iter(letter for letter in "ZYX" if letter not in known)
    found = [
        axis if is_said else replace(axis, letter=next(left))
        for axis, is_said in zip(axes, is_known, strict=True)
    ]
    # Height first, as grids of the world come here.
    order = [next(axis for axis in found if axis.letter == letter) for letter in "ZYX"]
    others = [axis for axis in order if axis.letter not in known]
    if not others:
        return order, SAID, ()
    names, letters = ", ".join(a.name for a in others), ", ".join(_CALLED[a.letter] for a in others)
    verb = "is" if len(others) == 1 else "are"
    text = f"{file} does not say which way its axes go: {names} {verb} {letters}"
    # Beside two axes that are known the third is what they are not.
    if "Z" in known or len(others) == 1:
        return order, SAID, (text.replace("its axes go", "all of its axes go"),)
    second = next(axis.name for axis in order if axis.letter == "Y")
    return order, TAKEN, (f"{text} (--up y takes {second} as up)",)


def is_measured(attributes: dict[str, Any]) -> bool:
    """Whether a coordinate's units say where its cells are: a length, a pressure or degrees."""
    units = str(attributes.get("units", ""))
    return bool(metres_of(units) or pascals_of(units)) or units.strip().lower().startswith("degree")


def is_downwards(name: str, attributes: dict[str, Any], centres: F64 | None) -> bool:
    """Whether a coordinate grows downwards, as it says; depths do unless they are below 0."""
    said = str(attributes.get("positive", "")).lower()
    if said in ("up", "down"):
        return said == "down"
    is_depth = name.lower().startswith("depth") or attributes.get("standard_name") == "depth"
    return is_depth and centres is not None and float(centres.max()) > 0.0
