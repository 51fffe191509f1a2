"""A slice through a density grid in false colours, and the transfer function beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...maths.arrays import F32, F64, U8
from ...scene.volume import Volume

Axis = Literal["x", "y", "z"]
_STOPS = {  # colours at equal steps, sRGB; after matplotlib's (CC0) and Moreland's
    "viridis": ("440154", "414487", "2a788e", "22a884", "7ad151", "fde725"),
    "inferno": ("000004", "420a68", "932667", "dd513a", "fca50a", "fcffa4"),
    "cool to warm": ("3b4cc0", "7b9ff9", "c0d4f5", "f2cbb7", "ee8468", "b40426"),
    "grey": ("000000", "ffffff"),
}
COLOURS = tuple(_STOPS)
WIDTH = 240
_LEAST_SIDE = 24
_ALONG: dict[Axis, int] = {"x": 2, "y": 1, "z": 0}  # axes of arrays (z, y, x)
_RIGHT, _UPWARDS = {"x": "z", "y": "x", "z": "x"}, {"x": "y", "y": "-z", "z": "y"}
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
    """A grid as it was loaded, and how it is looked at; its chart is drawn when that changes.

    `box` (2, 3): where its corners are along its own axes, metres. `top`: its largest density, or
    that of the moment whose densities count, where they move. Without a `view` the slice lies
    across y where most is.
    """

    def __init__(
        self,
        density: F32,
        view: Slice | None = None,
        box: F64 | None = None,
        top: float | None = None,
    ) -> None:
        self.density = density
        self.view = view or Slice(share=fullest(density, "y"))
        # Voxels are cubes where nothing is said of them.
        cubes = np.array([(0.0,) * 3, density.shape[::-1]])
        self.box = cubes if box is None else box
        self.top = most(density) if top is None else top
        self._chart: U8 | None = None

    @classmethod
    def of(cls, volume: Volume, density: F32) -> Sliced:
        """The grid of a volume."""
        return cls(density, box=box_m(volume))

    @property
    def chart(self) -> U8:
        """(h, w, 3) of `density_chart`."""
        if self._chart is None:
            self._chart = density_chart(self)
        return self._chart

    def seen(self, view: Slice) -> Sliced:
        """The same grid, looked at otherwise."""
        return Sliced(self.density, view, self.box, self.top)

    def now(self, volume: Volume, density: F32) -> Sliced:
        """Another moment of the same grid, looked at in the same way."""
        return Sliced(density, self.view, box_m(volume), self.top)

    @property
    def span(self) -> tuple[float, float]:
        """From where to where, metres, the slice can lie."""
        low, high = self.box[:, "xyz".index(self.view.axis)]
        return float(low), float(high)


def box_m(volume: Volume) -> F64:
    """(2, 3): the corners of a volume along its own axes, as long as they are in the world."""
    sides = np.linalg.norm(volume.world_from_volume[:3, :3], axis=0)
    return np.asarray(np.array(volume.bounds) * sides)


def fullest(density: F32, axis: Axis) -> float:
    """Where along an axis the plane with the most in it lies, 0 to 1; else the middle."""
    along = _ALONG[axis]
    sums = density.sum(axis=tuple(i for i in range(3) if i != along), dtype=np.float64)
    # Of planes that are as full as each other the middle one.
    count = len(sums)
    full = np.flatnonzero(sums >= 0.999 * sums.max())
    return float(full[np.argmin(np.abs(full - (count - 1) / 2.0))] + 0.5) / count


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
    along = _ALONG[view.axis]
    count = density.shape[along]
    cut = density.take(min(int(view.share * count), count - 1), axis=along)
    # Columns: x, or z of a plane across x; rows: y upwards, or z towards us of a plane across y.
    return np.asarray(cut.T[::-1] if view.axis == "x" else cut[::-1] if view.axis == "z" else cut)


def coloured(shares: NDArray[Any], colours: str) -> U8:
    """Values in 0 to 1 (...,) as sRGB (..., 3)."""
    table = np.array([[int(c[i : i + 2], 16) for i in (0, 2, 4)] for c in _STOPS[colours]])
    at = np.linspace(0.0, 1.0, len(table))
    return np.stack([np.interp(shares, at, table[:, i]) for i in range(3)], -1).astype(np.uint8)


def density_chart(sliced: Sliced) -> U8:
    """The plane, the colours, and how often each density is, with the transfer function over it."""
    view, top = sliced.view, sliced.top
    shown = transferred(plane(sliced.density, view), view, top) / top
    # Rows and columns are repeated or dropped, never blended: the chart shows voxels as they are.
    height, width = shown.shape
    wide, tall = _sides(sliced)
    rows = (np.arange(tall) * height) // tall
    columns = (np.arange(wide) * width) // wide
    image = np.full((tall, WIDTH, 3), _GROUND, np.uint8)
    left = (WIDTH - wide) // 2
    image[:, left : left + wide] = coloured(shown[rows][:, columns], view.colours)
    # Under the plane the scale of colours, then the histogram.
    scale = np.linspace(0.0, 1.0, WIDTH)[None].repeat(8, 0)
    gap = np.full((4, WIDTH, 3), _GROUND, np.uint8)
    curve = _curve(sliced.density, view, top)
    return np.vstack([image, gap, coloured(scale, view.colours), gap, curve])


def _sides(sliced: Sliced) -> tuple[int, int]:
    """Width and height of the plane, pixels, in the shape that it has in the world."""
    right, upwards = _RIGHT[sliced.view.axis], _UPWARDS[sliced.view.axis]
    across, along = (sliced.box[1] - sliced.box[0])[["xyz".index(right), "xyz".index(upwards[-1])]]
    scale = WIDTH / max(across, along)
    return max(round(scale * across), _LEAST_SIDE), max(round(scale * along), _LEAST_SIDE)


def caption(sliced: Sliced, sigma_t: float) -> str:
    """What the chart's directions and colours mean; `sigma_t` is 1/m at density 1."""
    said = []
    for word, axis in ("right", _RIGHT[sliced.view.axis]), ("up", _UPWARDS[sliced.view.axis]):
        low, high = sliced.box[:, "xyz".index(axis[-1])]
        low, high = (-high, -low) if axis[0] == "-" else (low, high)
        said.append(f"{word}: {axis}, {_number(low)} to {_number(high)} m")
    top = sliced.top
    said.append(f"colours: density 0 to {top:.4g},")
    said.append(f"extinction 0 to {sigma_t * top:.3g} 1/m")
    return "\n".join(said)


def _number(value: float) -> str:
    # Without -0.
    return f"{value + 0.0:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


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
