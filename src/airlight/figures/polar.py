"""Angular plots: how much light goes which way, in cells of a slice."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import PIL.Image
import PIL.ImageDraw
import PIL.ImageFont
from numpy.typing import NDArray

from ..app.compare_pictures import FAINT, INK, PAPER, U8
from ..scene.checks import F64

TRUTH = (232, 84, 72)
OURS = (92, 160, 255)
_GRID = (44, 44, 48)
_OVERSAMPLED = 2


def polar_plots(curves: Sequence[tuple[tuple[int, int, int], F64]], side_px: int) -> U8:
    """A square picture (side, side, 3) of plots (rows, columns, angles), rows upwards.

    `curves`: colours, and values at equally spaced azimuths from +x towards +y of the picture. One
    scale per plot, the root of the value: weak light stays visible.
    """
    rows, columns = curves[0][1].shape[:2]
    side = _OVERSAMPLED * side_px
    picture = PIL.Image.new("RGB", (side, side), PAPER)
    pen = PIL.ImageDraw.Draw(picture)
    step = side / max(rows, columns)
    largest = np.max([np.max(values, axis=-1) for _, values in curves], axis=0)
    for row in range(rows):
        for column in range(columns):
            x, y = (column + 0.5) * step, side - (row + 0.5) * step
            r = 0.47 * step
            pen.ellipse((x - r, y - r, x + r, y + r), outline=_GRID, width=_OVERSAMPLED)
            for colour, values in curves:
                line = _outline(values[row, column], float(largest[row, column]), r)
                pen.line(
                    [(x + dx, y - dy) for dx, dy in line], fill=colour, width=_OVERSAMPLED,
                    joint="curve",
                )  # fmt: skip
    small = picture.resize((side_px, side_px), PIL.Image.Resampling.LANCZOS)
    return np.asarray(small, dtype=np.uint8)


def _outline(values: F64, largest: float, radius_px: float) -> list[tuple[float, float]]:
    angle = 2.0 * np.pi * np.arange(len(values) + 1) / len(values)
    size = radius_px * np.sqrt(np.maximum(np.append(values, values[0]), 0.0) / max(largest, 1e-30))
    points: NDArray[np.float64] = np.stack([size * np.cos(angle), size * np.sin(angle)], axis=-1)
    return [(float(px), float(py)) for px, py in points]


def curves_plot(
    title: str, series: Sequence[tuple[str, tuple[int, int, int], Sequence[float], Sequence[float]]],
    size: tuple[int, int], *, labels: tuple[str, str],
) -> U8:  # fmt: skip
    """A line chart with logarithmic axes: (name, colour, x, y) per series."""
    width, height = size
    picture = PIL.Image.new("RGB", size, PAPER)
    pen, font = PIL.ImageDraw.Draw(picture), PIL.ImageFont.load_default(14)
    left, right, top, bottom = 64, width - 16, 40, height - 36
    xs = np.log(np.concatenate([np.asarray(s[2], float) for s in series]))
    ys = np.log(np.maximum(np.concatenate([np.asarray(s[3], float) for s in series]), 1e-12))
    (x0, x1), (y0, y1) = _span(xs), _span(ys)
    pen.text((left, 12), title, INK, font=font)
    pen.rectangle((left, top, right, bottom), outline=_GRID)
    pen.text((left, bottom + 10), f"{labels[0]}: {np.exp(x0):.3g} to {np.exp(x1):.3g}", FAINT, font)
    for value, at in ((y1, top), (y0, bottom - 14)):
        pen.text((4, at), f"{np.exp(value):.3g}", FAINT, font=font)
    pen.text((right - font.getlength(labels[1]), 12), labels[1], FAINT, font=font)
    for index, (name, colour, x, y) in enumerate(series):
        px = left + (np.log(np.asarray(x, float)) - x0) / (x1 - x0) * (right - left)
        py = bottom - (np.log(np.maximum(np.asarray(y, float), 1e-12)) - y0) / (y1 - y0) * (
            bottom - top
        )
        pen.line([(float(a), float(b)) for a, b in zip(px, py, strict=True)], colour, 2)
        pen.text((left + 8, top + 6 + 18 * index), name, colour, font=font)
    return np.asarray(picture, dtype=np.uint8)


def _span(values: F64) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > low else (low - 0.5, high + 0.5)
