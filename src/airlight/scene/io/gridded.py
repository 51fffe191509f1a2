"""Scientific grids in the world: their axes in metres, and evenly spaced.

A world here has +Y up, so a file's x goes along +X, its height along +Y and its y (north) along -Z.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from ..checks import F32, F64, Bounds
from .dense_grid import box_of
from .netcdf_axes import SEA_LEVEL_PA, Axis, metres_of, pascals_of

LARGEST_SIDE = 2048
_DEGREE_M = 111_195.0  # of latitude
_SCALE_HEIGHT_M = 7400.0
_NEEDLE, _SHEET = 50.0, 300.0  # times as long as wide, and as wide as deep
_FAR = 10.0  # times its size from the origin: a grid is moved there


@dataclass(frozen=True, eq=False)
class Placed:
    """Values (z, y, x) of a world whose Y is up, their box in metres, cells' heights, doubts."""

    values: F32
    box: Bounds
    heights_m: F64
    warnings: tuple[str, ...]


def placed(values: NDArray[Any], axes: list[Axis], file: str) -> Placed:
    """Values along three axes Z, Y and X of a file, as a grid of the world. Raises SceneError."""
    doubts: list[str] = []
    # Degrees of longitude are as long as at the grid's middle latitude.
    latitude = next((a.centres for a in axes if a.units.lower().startswith("degree")
                     and a.letter == "Y"), None)  # fmt: skip
    middle = 0.0 if latitude is None else float(np.mean(latitude))
    # Each axis in metres, upwards, at even steps, as a volume's voxels need them.
    lines = [_metres(axis, middle, doubts) for axis in axes]
    sampled: NDArray[Any] = np.asarray(values, np.float32)
    evens = []
    for k, line in enumerate(lines):
        # An axis that runs down is turned about with its values.
        if line[0] > line[-1]:
            line, sampled = line[::-1], np.flip(sampled, k)
        even = _even(line, axes[k].name, doubts)
        sampled = _resampled(sampled, k, line, even)
        evens.append(even)
    height, north, east = evens
    # (height, north, east) -> z = -north backwards, y = height, x = east.
    turned = np.ascontiguousarray(np.flip(sampled.transpose(1, 0, 2), 0), np.float32)
    ends = [_ends(even) for even in (east, height, north)]
    # Horizontally a grid may lie anywhere on its map; its height above the ground is kept.
    for k, name in ((0, "x"), (2, "y")):
        ends[k] = _near(ends[k], name, doubts)
    (west, e), (low, high), (south, n) = ends
    box = box_of((west, low, -n), (e, high, -south), "Write its coordinates")
    doubts += _thin(np.subtract(box[1], box[0]))
    return Placed(turned, box, height, tuple(f"{file}: {text}" for text in doubts))


def _thin(size: F64) -> list[str]:
    """What to tell of a box (3,), metres, so thin that it shows next to nothing.

    Units that are mixed up make one, and the air of large maps is one.
    """
    least, middle, most = np.sort(size)
    large = f"it is {' x '.join(f'{side:.3g}' for side in size)} m large, thin as a"
    if most > _NEEDLE * middle:
        return [f"{large} needle: look at the units of its axes"]
    if middle > _SHEET * least:
        factor = [f"{middle / (10.0 * least):.1g}" if side == least else "1" for side in size]
        by = f"scale = [{', '.join(f'{float(f):g}' for f in factor)}] of a [[volume]]"
        return [f"{large} sheet: look at the units of its axes, or stretch it by {by}"]
    return []


def _metres(axis: Axis, latitude: float, doubts: list[str]) -> F64:
    """Centres of cells in metres."""
    # Cells without coordinates are a metre wide.
    if axis.centres is None:
        doubts.append(f"'{axis.name}' has no coordinates: its cells are taken as 1 m")
        return np.asarray(np.arange(axis.size) + 0.5, np.float64)
    doubts += [axis.doubt] if axis.doubt else []
    # Coordinates have to go one way, so that values between them have a place.
    units = axis.units.strip().lower().rstrip(".")
    centres = np.asarray(axis.centres, np.float64)
    # Longitudes may pass from 360 to 0.
    if units.startswith("degree") and axis.letter == "X" and np.isfinite(centres).all():
        centres = np.unwrap(centres, period=360.0)
    if not np.isfinite(centres).all() or (np.sign(np.diff(centres)) == 0).any():
        raise SceneError(
            f"its coordinate '{axis.name}' has equal or missing values",
            remedy=f"xarray: drop_duplicates('{axis.name}'), or dropna('{axis.name}').",
        )
    if np.unique(np.sign(np.diff(centres))).size > 1:
        raise SceneError(
            f"its coordinate '{axis.name}' goes up and down",
            remedy=f"xarray: sortby('{axis.name}').",
        )
    # h = H ln(p0 / p), the isothermal atmosphere.
    if (pascals := pascals_of(units)) is not None:
        if float(centres.min()) <= 0.0:
            raise SceneError(
                f"its pressure '{axis.name}' is not above 0",
                remedy=f"Mend its units, which are {axis.units}, or leave those levels out.",
            )
        doubts.append(f"heights of '{axis.name}' are estimated from its pressures")
        return np.asarray(_SCALE_HEIGHT_M * np.log(SEA_LEVEL_PA / (centres * pascals)))
    # Degrees of longitude shrink by the cosine of the latitude.
    if units.startswith("degree"):
        doubts.append(f"degrees of '{axis.name}' are taken as metres on a flat ground")
        shrunk = math.cos(math.radians(latitude)) if axis.letter == "X" else 1.0
        return np.asarray(centres * _DEGREE_M * shrunk)
    # Unknown units pass for metres.
    factor = metres_of(units)
    if factor is None:
        doubts.append(f"units '{axis.units}' of '{axis.name}' are taken as metres")
        factor = 1.0
    return np.asarray(centres * (-factor if axis.is_down else factor))


def _even(line: F64, name: str, doubts: list[str]) -> F64:
    """Evenly spaced centres between the ends of `line`, as fine as its median spacing."""
    if len(line) < 3:
        return line
    # Spacings that differ by under 1 % of their mean are even but for rounding.
    steps = np.diff(line)
    if float(np.ptp(steps)) <= 0.01 * float(steps.mean()):
        return np.linspace(line[0], line[-1], len(line))
    # As fine as the median spacing, so that a few wide cells do not coarsen all of it.
    count = round(float((line[-1] - line[0]) / np.median(steps))) + 1
    count = min(max(count, len(line)), LARGEST_SIDE)
    doubts.append(f"'{name}' is not evenly spaced: {len(line)} cells became {count} even ones")
    return np.linspace(line[0], line[-1], count)


def _resampled(values: NDArray[Any], axis: int, line: F64, even: F64) -> NDArray[Any]:
    """`values` along `axis` at `even` instead of at `line`, linearly."""
    if len(line) == len(even) and np.allclose(line, even, rtol=0.0, atol=0.01 * _step(even)):
        return values
    # The two old cells around each new centre, and how far between them it lies.
    upper = np.clip(np.searchsorted(line, even), 1, len(line) - 1)
    share = (even - line[upper - 1]) / (line[upper] - line[upper - 1])
    shape = [1, 1, 1]
    shape[axis] = -1
    weight = np.clip(share, 0.0, 1.0).reshape(shape).astype(np.float32)
    low, high = np.take(values, upper - 1, axis), np.take(values, upper, axis)
    return np.asarray(low * (1.0 - weight) + high * weight)


def _step(even: F64) -> float:
    return float(even[1] - even[0]) if len(even) > 1 else 1.0


def _ends(even: F64) -> tuple[float, float]:
    half = 0.5 * _step(even)
    return float(even[0]) - half, float(even[-1]) + half


def _near(ends: tuple[float, float], name: str, doubts: list[str]) -> tuple[float, float]:
    """The ends about 0 where they lie far from it, as in map projections."""
    low, high = ends
    middle = 0.5 * (low + high)
    if abs(middle) <= _FAR * (high - low):
        return ends
    doubts.append(f"it was moved by {-middle:g} m along its {name}, to the origin")
    return low - middle, high - middle
