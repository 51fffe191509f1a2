"""A solved lattice cut open: fluence in false colour, its direction, and the walls between cells.

Arrays of lattices are (Z, Y, X, ...). A slice is across one axis; its rows go up the image:

across "x"   right +z, up +y        across "y"   right +x, up -z (a plan)
across "z"   right +x, up +y
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..app.compare.images import heat
from ..maths.arrays import U8
from ..maths.colour import luminance
from ..maths.lattice6 import LOOKUP_SCALE
from ..scene.checks import F32, F64

AXES = {"x": (2, 1), "y": (0, 2), "z": (0, 1)}
"""World axes that run (right, up) in the slice across each."""
WALL = np.array([90, 235, 255], dtype=np.float64)
ARROW = np.array([255, 255, 255], dtype=np.float64)
_LINE_PX = 1.0  # half width of a wall's line and of an arrow


@dataclass(frozen=True, eq=False)
class SolvedLattice:
    """`intensity` (Z, Y, X, 3, 4): per cell and channel (a, bx, by, bz), W/sr.

    `openness` (Z, Y, X, 6): the share in [0, 1] of light on each incoming hop (+x -x +y -y +z -z)
    that passes.
    """

    intensity: F64
    openness: F64
    cell_m: float

    @property
    def fluence(self) -> F64:
        """(Z, Y, X, 3), W m^-2."""
        return 4.0 * np.pi * LOOKUP_SCALE / self.cell_m**2 * self.intensity[..., 0]

    @property
    def direction(self) -> F64:
        """(Z, Y, X, 3): net flux over what would flow if all went one way, from luminance."""
        # Luminance of both bands; 3 a is the most that b can be.
        a = luminance(self.intensity[..., 0])
        b = np.stack([luminance(self.intensity[..., k]) for k in (1, 2, 3)], axis=-1)
        return b / np.maximum(3.0 * np.abs(a), 1e-30)[..., None]


def from_texels(
    red: NDArray[Any],
    green: NDArray[Any],
    blue: NDArray[Any],
    open_xy: NDArray[np.uint8],
    open_z: NDArray[np.uint8],
    *,
    power_scale: float,
    cell_m: float,
) -> SolvedLattice:
    """What the device's textures hold: (Z, Y, X, 4) half floats, stored units over `power_scale`;
    openness as bytes of hops (+x -x +y -y) and (+z -z .. ..).
    """
    # To W sr^-1 and shares.
    channels = [np.asarray(t, dtype=np.float64) / power_scale for t in (red, green, blue)]
    hops = np.concatenate([open_xy, open_z[..., :2]], axis=-1).astype(np.float64) / 255.0
    return SolvedLattice(np.stack(channels, axis=-2), hops, cell_m)


def cut(volume: F64, across: str, index: int) -> F64:
    """The slice (rows from the top, columns, ...) of a (Z, Y, X, ...) array."""
    if across == "x":
        return volume[:, :, index].swapaxes(0, 1)[::-1]
    if across == "y":
        return volume[:, index]
    return volume[index, ::-1]


def slice_image(
    lattice: SolvedLattice, across: str, index: int, *, brightest: float, cell_px: int = 16
) -> U8:
    """Luminance of the fluence on a scale of stops below `brightest` (W m^-2), walls, arrows.

    The colour goes from black at 2^-8 of `brightest` to white; walls are bright lines on the
    side of the cell that is closed; arrows, as long as light is directed, show where it goes.
    """
    # Fluence as stops below the brightest.
    light = cut(luminance(lattice.fluence), across, index)
    stops = np.log2(np.maximum(light, 1e-30) / max(brightest, 1e-30)) / 8.0 + 1.0
    colours = heat(cast(F32, np.clip(stops, 0.0, 1.0).astype(np.float32)))
    pixels = magnified(colours.astype(np.float64), cell_px)

    # Arrows of the light's direction in the slice, and lines where faces are closed.
    right, up = _in_slice(lattice.direction, across, index)
    along = arrows(np.stack([right, up], axis=-1), cell_px)
    pixels += (ARROW - pixels) * (0.85 * along)[..., None]
    closed = walls(_sides(1.0 - lattice.openness, across, index), cell_px)
    pixels += (WALL - pixels) * closed[..., None]
    return np.rint(pixels).astype(np.uint8)


def magnified(cells: F64, cell_px: int) -> F64:
    """(rows, columns, ...) with each cell a square of `cell_px` pixels."""
    return cells.repeat(cell_px, axis=0).repeat(cell_px, axis=1)


def _in_slice(vectors: F64, across: str, index: int) -> tuple[F64, F64]:
    """Components (right, up) of world vectors (Z, Y, X, 3)."""
    # Axes of the world that lie in the slice.
    right, up = AXES[across]
    plane = cut(vectors, across, index)
    # The plan's image has -z at its top.
    sign = -1.0 if across == "y" else 1.0
    return plane[..., 0 if across == "y" else right], sign * plane[..., 2 if across == "y" else up]


def _sides(closed: F64, across: str, index: int) -> F64:
    """Closed shares (rows, columns, 4) of a cell's left, right, lower and upper side.

    A hop along +x comes in through the side at low x.
    """
    plane = cut(closed, across, index)
    order = {"x": (4, 5, 2, 3), "y": (0, 1, 5, 4), "z": (0, 1, 2, 3)}[across]
    return plane[..., list(order)]


def _places(cell_px: int) -> tuple[F64, F64]:
    """Pixel centres in a cell, (right, up) from its centre in pixels, each (cell_px, cell_px)."""
    at = np.arange(cell_px) + 0.5 - 0.5 * cell_px
    right, down = np.meshgrid(at, at)
    return right, -down


def walls(sides: F64, cell_px: int) -> F64:
    """Cover (rows cell_px, columns cell_px) in [0, 1] of lines along closed sides."""
    right, up = _places(cell_px)
    edge = 0.5 * cell_px - 2.0 * _LINE_PX
    near = np.stack([right < -edge, right > edge, up < -edge, up > edge]).astype(np.float64)
    cover = np.max(sides[..., :, None, None] * near, axis=2)
    return _joined(cover)


def arrows(vectors: F64, cell_px: int) -> F64:
    """Cover of a stroke from each cell's centre along its vector (rows, columns, 2), at most 1.

    A dot marks where it starts.
    """
    right, up = _places(cell_px)

    # From the cell's middle along its vector; no arrow leaves its cell.
    reach = 0.45 * cell_px * vectors / np.maximum(np.linalg.norm(vectors, axis=-1), 1.0)[..., None]
    x, y = reach[..., 0, None, None], reach[..., 1, None, None]

    # The nearest point of the stroke, and how far the pixel is from it.
    share = np.clip((right * x + up * y) / np.maximum(x * x + y * y, 1e-9), 0.0, 1.0)
    distance = np.hypot(right - share * x, up - share * y)
    width = _LINE_PX * (1.4 - 0.9 * share)  # thick where it starts
    return _joined(np.clip(width + 0.5 - distance, 0.0, 1.0))


def _joined(cells: F64) -> F64:
    """(rows, columns, h, w) as one image (rows h, columns w)."""
    rows, columns, h, w = cells.shape
    return cast(F64, cells.swapaxes(1, 2).reshape(rows * h, columns * w))
