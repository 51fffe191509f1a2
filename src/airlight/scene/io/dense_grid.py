"""What readers of dense grids give: values, where they lie, and what their units say of light."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, nearest
from .. import checks
from ..checks import F32, F64, Bounds

LARGEST_VALUE_COUNT = 1 << 30
"""Values in one grid, channels counted; more would need over 4 GiB."""
SAID, TAKEN = "said", "taken"
"""Of which axis is the height of a grid: the file says it, or the first one stands for it."""


@dataclass(frozen=True)
class Optics:
    """The medium that a grid's units say it is: `sigma_t` per metre at value 1, albedo and g.

    `text` says how that follows.
    """

    sigma_t: float
    albedo: float
    g: float
    text: str


@dataclass(frozen=True, eq=False)
class DenseGrid:
    """A grid of a file: `values` (z, y, x) or (z, y, x, channel), as the file has them.

    `bounds` is its box in metres, None where the file has none; `world_from_volume` (4, 4) comes
    after it. `optics` is None where the file's units say nothing of light, `time` where it is
    static, else which of its times this is. `upright`: whether height goes along +Y because the
    file says it (SAID), or since an axis that has no name was TAKEN; else the axes are as they are.
    """

    values: NDArray[Any]
    bounds: Bounds | None = None
    world_from_volume: F64 = field(default_factory=lambda: np.eye(4))
    warnings: tuple[str, ...] = ()
    optics: Optics | None = None
    time: int | None = None
    upright: str = ""


def check_count(count: int) -> None:
    """Raise SceneError for more values than can be used."""
    if count > LARGEST_VALUE_COUNT:
        raise SceneError(
            f"has {count:,} values, at most {LARGEST_VALUE_COUNT:,} can be used",
            remedy="Downsample it.",
        )


def box_of(low: Any, high: Any, how: str) -> Bounds:
    """The box from `low` to `high` (3,), metres. Raises SceneError, with `how` that is mended."""
    try:
        return checks.bounds((low, high), "its box")
    except SceneError as error:
        remedy = f"{how} so that lengths are metres, or in a larger unit and give the grid a scale."
        raise SceneError(error.problem, remedy=remedy) from None


def chosen_name(wanted: str, names: list[str], likely: tuple[str, ...]) -> str:
    """The grid called `wanted`; for "density", which is nobody's wish, the most likely one.

    That is the only one, or the first of `likely` that is there. Raises SceneError.
    """
    # The name as it was asked for, wherever there is such a grid.
    if wanted in names:
        return wanted
    if not names:
        raise SceneError("holds no grid of three dimensions")
    # "density" is the default, so it may stand for another name; any other name is a wish.
    found = [n for n in likely if n in names] or (names if len(names) == 1 else [])
    if wanted != "density" or not found:
        known = nearest(wanted, names)
        raise SceneError(f"has no grid '{wanted}'", remedy=known + HOW)
    return found[0]


def without_missing(
    values: NDArray[Any], name: str, file: str
) -> tuple[NDArray[Any], tuple[str, ...]]:
    """Values that are NaN, which say that there is none, as 0; and what to tell of them."""
    if values.dtype.kind != "f" or not values.size or not math.isnan(float(values.min())):
        return values, ()
    is_missing = np.isnan(values)
    text = f"{file}: '{name}' has {int(is_missing.sum()):,} missing values, taken as 0"
    return np.where(is_missing, values.dtype.type(0), values), (text,)


def warnings_of(density: F32, path: Path) -> tuple[str, ...]:
    """Warnings of values that mean nothing. Raises SceneError for those that cannot be used."""
    if density.size == 0:
        raise SceneError(f"is empty: its shape is {density.shape}", where=path)
    least, most = float(density.min()), float(density.max())
    if not math.isfinite(least) or not math.isfinite(most):
        count = int((~np.isfinite(density)).sum())
        raise SceneError(
            f"{count:,} of its {density.size:,} values {'is' if count == 1 else 'are'} infinite",
            where=path,
            remedy="Repair it. NaN, no value, is read as 0.",
        )
    if least < 0.0:
        raise SceneError(
            f"has negative densities, down to {least:g}",
            where=path,
            remedy="A density is at least 0: numpy.clip.",
        )
    if most > checks.MOST:
        raise SceneError(
            f"its density holds {most:g}, at most {checks.MOST:g} can be used",
            where=path,
            remedy="Write it in another unit. A number that stands for no value is to be 0.",
        )
    return (f"{path.name} holds no density at all: there is nothing to see",) if most == 0 else ()


HOW = ' --grid NAME, or grid = "NAME" of a [[volume]] in a scene file, chooses one.'
