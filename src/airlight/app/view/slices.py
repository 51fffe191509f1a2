"""A slice through a density grid in false colours, and the transfer function beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...scene.checks import F32

U8 = np.ndarray[Any, np.dtype[np.uint8]]
Axis = Literal["x", "y", "z"]
_STOPS = {  # colours at equal steps, sRGB; after matplotlib's (CC0) and Moreland's
    "viridis": ("440154", "414487", "2a788e", "22a884", "7ad151", "fde725"),
    "inferno": ("000004", "420a68", "932667", "dd513a", "fca50a", "fcffa4"),
    "cool to warm": ("3b4cc0", "7b9ff9", "c0d4f5", "f2cbb7", "ee8468", "b40426"),
    "grey": ("000000", "ffffff"),
}
COLOURS = tuple(_STOPS)
WIDTH = 240
_CURVE_HEIGHT, _BINS = 44, 60
_BAR, _LINE, _GROUND = (96, 108, 124), (240, 180, 84), (28, 30, 34)


@dataclass(frozen=True)
class Slice:
    """Which plane of a grid is shown and in which colours; `low` to `high`: the densities, as
    shares of the largest, that go from empty to full.
    """

    axis: Axis = "y"
    share: float = 0.5
    colours: str = "viridis"
    low: float = 0.0
    high: float = 1.0

    @property
    def is_plain(self) -> bool:
        """Whether densities are as the file has them."""
        return self.low <= 0.0 and self.high >= 1.0


class Sliced:
    """A grid as it was loaded, and how it is looked at; its chart is drawn when that changes."""

    def __init__(self, density: F32, view: Slice | None = None) -> None:
        self.density, self.view = density, view or Slice()
        self.top = most(density)
        self._chart: U8 | None = None

    @property
    def chart(self) -> U8:
        """(h, w, 3) of `density_chart`."""
        if self._chart is None:
            self._chart = density_chart(self.density, self.view)
        return self._chart

    def seen(self, view: Slice) -> Sliced:
        """The same grid, looked at otherwise."""
        return Sliced(self.density, view)


def most(density: F32) -> float:
    """The largest density, 1 in an empty grid."""
    return float(density.max()) or 1.0


def transferred(density: F32, view: Slice, top: float) -> F32:
    """Densities from `low` to `high` spread from nothing to `top`, the largest of the grid.

    `view.low` and `view.high` that meet make a step.
    """
    if view.is_plain:
        return density
    # Limits that meet are a step of a thousandth.
    low, high = view.low * top, max(view.high, view.low + 1e-3) * top
    return np.asarray(np.clip((density - low) / (high - low), 0.0, 1.0) * top, np.float32)


def plane(density: F32, view: Slice) -> F32:
    """The densities (rows, columns) of a plane, its up or north at the top."""
    # The axis of the array (z, y, x) that the plane lies across.
    along = {"x": 2, "y": 1, "z": 0}[view.axis]
    count = density.shape[along]
    cut = density.take(min(int(view.share * count), count - 1), axis=along)
    # Columns: x, or z of a plane across x; rows: y upwards, or z towards us of a plane across y.
    return np.asarray(cut.T[::-1] if view.axis == "x" else cut[::-1] if view.axis == "z" else cut)


def coloured(shares: NDArray[Any], colours: str) -> U8:
    """Values in 0 to 1 (...,) as sRGB (..., 3)."""
    table = np.array([[int(c[i : i + 2], 16) for i in (0, 2, 4)] for c in _STOPS[colours]])
    at = np.linspace(0.0, 1.0, len(table))
    return np.stack([np.interp(shares, at, table[:, i]) for i in range(3)], -1).astype(np.uint8)


def density_chart(density: F32, view: Slice) -> U8:
    """The plane, the colours, and how often each density is, with the transfer function over it."""
    # Rows and columns are repeated or dropped, never blended: the chart shows voxels as they are.
    top = most(density)
    shown = transferred(plane(density, view), view, top) / top
    height, width = shown.shape
    tall = min(max(round(WIDTH * height / width), 24), WIDTH)
    rows = (np.arange(tall) * height) // tall
    columns = (np.arange(WIDTH) * width) // WIDTH
    image = coloured(shown[rows][:, columns], view.colours)
    # Under the plane the scale of colours, then the histogram.
    scale = np.linspace(0.0, 1.0, WIDTH)[None].repeat(8, 0)
    gap = np.full((4, WIDTH, 3), _GROUND, np.uint8)
    return np.vstack([image, gap, coloured(scale, view.colours), gap, _curve(density, view, top)])


def _curve(density: F32, view: Slice, top: float) -> U8:
    """A histogram of the densities above none, logarithmic, and the transfer function."""
    chart = np.full((_CURVE_HEIGHT, WIDTH, 3), _GROUND, np.uint8)
    # Empty voxels would dwarf all others, and the logarithm shows rare densities.
    counts, _ = np.histogram(density[density > 0.0], _BINS, (0.0, top))
    bars = np.log1p(counts) / max(np.log1p(counts).max(), 1e-9)
    tall = bars[(np.arange(WIDTH) * _BINS) // WIDTH] * _CURVE_HEIGHT
    from_below = np.arange(_CURVE_HEIGHT, 0, -1)[:, None]
    chart[from_below <= tall[None]] = _BAR
    # The transfer function over them, along the same densities.
    x: F32 = ((np.arange(WIDTH) + 0.5) / WIDTH).astype(np.float32)
    y = transferred(x, view, 1.0)
    row = np.rint((1.0 - y) * (_CURVE_HEIGHT - 2)).astype(int)
    # A steep curve is joined from column to column.
    before = np.concatenate([row[:1], row[:-1]])
    lines = np.arange(_CURVE_HEIGHT)[:, None]
    chart[(lines >= np.minimum(row, before)) & (lines <= np.maximum(row, before) + 1)] = _LINE
    return chart
