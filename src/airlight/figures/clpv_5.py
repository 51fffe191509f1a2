"""Flatland: how five schemes carry light across an empty plane (Kaplanyan2010 section 5)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np

from ..app.compare.images import heat
from ..maths.arrays import U8
from ..reference import flatland
from ..reference.flatland import ONE_LIGHT, TWO_LIGHTS, Segment
from ..scene.checks import F32, F64
from .panels import Drawn, Request, sheet

CELL_PX = 26
NAMES = {
    "dom8": "DOM8",
    "dom4": "DOM4",
    "paper": "LPV, paper",
    "ray": "LPV, along the ray",
    "centroid": "LPV, ours",
}
SETTINGS = {"one light": ONE_LIGHT, "two lights": TWO_LIGHTS}
LOBE = np.array([255.0, 255.0, 255.0])


def draw(request: Request) -> Drawn:
    """A row per setting and number of bands, the truth first."""
    rows = []
    numbers: dict[str, Any] = {
        "side_cells": flatland.SIDE_CELLS,
        "steps": flatland.STEPS,
        "error": "relative L2 of fluence after one scale",
        "relative_l2": {},
    }

    # Two bands, as lattices have them, and four.
    for bands in (2, 4):
        for label, lights in SETTINGS.items():
            errors, cells = _row(lights, bands)
            numbers["relative_l2"][f"{label}, {bands} bands"] = errors
            rows.append((f"{label}, {bands} bands", cells))
    return Drawn(sheet(request, "Flatland: light of each cell by direction", rows), numbers)


def _row(
    lights: Sequence[Segment], bands: int
) -> tuple[dict[str, float], list[tuple[str, U8 | None]]]:
    # Each scheme is scaled to fit best, so that shapes are compared.
    truth = flatland.analytic(lights, bands=bands)
    cells: list[tuple[str, U8 | None]] = [("analytic", polar_image(truth))]
    errors = {}
    for scheme, name in NAMES.items():
        found = flatland.solve(scheme, lights, bands=bands)
        errors[scheme], scale = flatland.relative_l2(found, truth)
        cells.append((f"{name}: {errors[scheme]:.3f}", polar_image(scale * found)))
    return errors, cells


def polar_image(coefficients: F64, cell_px: int = CELL_PX, brightest: float | None = None) -> U8:
    """Fluence in false colour, 8 stops below pi, and each cell's intensity as a polar plot.

    Plots are as large as the root of what they plot over `brightest`; all alike without it.
    """
    # Fluence as colour, in stops below that of a half circle of unit radiance.
    light = np.maximum(flatland.fluence(coefficients), 1e-9)[::-1]
    stops = np.clip(np.log2(light / np.pi) / 8.0 + 1.0, 0.0, 1.0)
    colours = heat(cast(F32, (0.8 * stops).astype(np.float32)))
    pixels = colours.astype(np.float64).repeat(cell_px, axis=0).repeat(cell_px, axis=1)

    # Lobes over it.
    cover = _lobes(coefficients[::-1], cell_px, brightest)
    pixels += (LOBE - pixels) * cover[..., None]
    return np.rint(pixels).astype(np.uint8)


def peaks(coefficients: F64) -> F64:
    """(rows, columns): each cell's intensity where it is largest."""
    # Enough directions for any lobe of so few bands.
    around = np.arange(64) * (2.0 * np.pi / 64)
    values = coefficients @ flatland.basis(around, (coefficients.shape[-1] + 1) // 2).T
    return np.asarray(np.maximum(values.max(axis=-1), 1e-12))


def _lobes(coefficients: F64, cell_px: int, brightest: float | None) -> F64:
    """How far each pixel is covered by a lobe or its outline, (rows cell_px, columns cell_px)."""
    # Polar coordinates of a cell's pixels about its middle.
    rows, columns, count = coefficients.shape
    bands = (count + 1) // 2
    at = np.arange(cell_px) + 0.5 - 0.5 * cell_px
    right, down = np.meshgrid(at, at)
    angle, radius = np.arctan2(-down, right), np.hypot(right, down)

    # How far the lobe reaches in each pixel's direction.
    intensity = coefficients @ flatland.basis(angle, bands).reshape(-1, count).T
    peak = peaks(coefficients)[..., None]
    size = 1.0 if brightest is None else np.sqrt(np.minimum(peak / brightest, 1.0))
    reach = 0.48 * cell_px * size * np.maximum(intensity, 0.0) / peak

    # Inside of the lobe faint, its rim bright.
    inside = np.clip(reach - radius.ravel() + 0.5, 0.0, 1.0)
    edge = inside * np.clip(1.5 - (reach - radius.ravel()), 0.0, 1.0)
    cover = (0.25 * inside + 0.6 * edge).reshape(rows, columns, cell_px, cell_px)
    return cast(F64, cover.swapaxes(1, 2).reshape(rows * cell_px, columns * cell_px))
