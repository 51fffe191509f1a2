"""What readers of dense grids give: values, where they lie, and what their units say of light."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, nearest
from ..checks import F64, Bounds

LARGEST_VALUE_COUNT = 1 << 30
"""Values in one grid, channels counted; more would need over 4 GiB."""


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
    static, else which of its times this is.
    """

    values: NDArray[Any]
    bounds: Bounds | None = None
    world_from_volume: F64 = field(default_factory=lambda: np.eye(4))
    warnings: tuple[str, ...] = ()
    optics: Optics | None = None
    time: int | None = None


def check_count(count: int) -> None:
    """Raise SceneError for more values than can be used."""
    if count > LARGEST_VALUE_COUNT:
        raise SceneError(
            f"has {count:,} values, at most {LARGEST_VALUE_COUNT:,} can be used",
            remedy="Downsample it.",
        )


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


HOW = ' --grid NAME, or grid = "NAME" of a [[volume]] in a scene file, chooses one.'
