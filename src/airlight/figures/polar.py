"""Angular plots: how much light goes which way, in cells of a slice."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import PIL.Image
import PIL.ImageDraw
from numpy.typing import NDArray

from ..app.compare.images import PAPER
from ..maths.arrays import U8
from ..scene.checks import F64

TRUTH = (232, 84, 72)
OURS = (92, 160, 255)
_GRID = (44, 44, 48)
_OVERSAMPLED = 2


def polar_plots(curves: Sequence[tuple[tuple[int, int, int], F64]], side_px: int) -> U8:
    """A square image (side, side, 3) of plots (rows, columns, angles), rows upwards.

    `curves`: colours, and values at equally spaced azimuths from +x towards +y of the image. One
    scale per plot, the root of the value: weak light stays visible.
    """
    # Drawn at twice the size, then reduced: lines are smooth.
    rows, columns = curves[0][1].shape[:2]
    side = _OVERSAMPLED * side_px
    image = PIL.Image.new("RGB", (side, side), PAPER)
    pen = PIL.ImageDraw.Draw(image)
    step = side / max(rows, columns)

    # One scale for all curves of a plot.
    largest = np.max([np.max(values, axis=-1) for _, values in curves], axis=0)
    for row in range(rows):
        for column in range(columns):
            x, y = (column + 0.5) * step, side - (row + 0.5) * step
            r = 0.47 * step
            pen.ellipse((x - r, y - r, x + r, y + r), outline=_GRID, width=_OVERSAMPLED)
            for colour, values in curves:
                line = _outline(values[row, column], float(largest[row, column]), r)
                pen.line(
                    [(x + dx, y - dy) for dx, dy in line],
                    fill=colour,
                    width=_OVERSAMPLED,
                    joint="curve",
                )
    small = image.resize((side_px, side_px), PIL.Image.Resampling.LANCZOS)
    return np.asarray(small, dtype=np.uint8)


def _outline(values: F64, largest: float, radius_px: float) -> list[tuple[float, float]]:
    # Closed: the last direction is the first one again.
    angle = 2.0 * np.pi * np.arange(len(values) + 1) / len(values)
    size = radius_px * np.sqrt(np.maximum(np.append(values, values[0]), 0.0) / max(largest, 1e-30))
    points: NDArray[np.float64] = np.stack([size * np.cos(angle), size * np.sin(angle)], axis=-1)
    return [(float(px), float(py)) for px, py in points]
