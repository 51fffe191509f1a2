"""A density grid on its own as a scene: something to look at before any scene file is written."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..checks import F32, Bounds
from ..scene import Scene
from ..volume import Volume
from .volumes import read_volume

DEPTH = 6.0
"""Optical depth through the denser parts, of the coefficient that is chosen for a bare grid."""
ALBEDO = 0.9


def load_volume_scene(file: Path) -> Scene:
    """The grid in `file` as whitish smoke; no light, no camera. Raises SceneError.

    A grid does not say how dense density 1 is: sigma_t is chosen for it, and a warning says so.
    """
    grid = read_volume(file)
    sigma_t = fitting_sigma_t(grid.density, grid.bounds)
    volume = Volume(
        sigma_t=(sigma_t,) * 3,
        density=grid.density,
        bounds=grid.bounds,
        albedo=(ALBEDO,) * 3,
        world_from_volume=grid.world_from_volume,
        source=str(file),
    )
    chosen = (
        f"{file.name} says nothing about light: sigma_t = {sigma_t:g} m^-1 and albedo = {ALBEDO} "
        "were chosen; a scene file with [[volume]] sets them"
    )
    return Scene(volumes=(volume,), name=file.stem, warnings=(*grid.warnings, chosen))


def fitting_sigma_t(density: F32, bounds: Bounds) -> float:
    """sigma_t, m^-1 at density 1, that makes the denser parts DEPTH deep; two digits."""
    size = np.subtract(bounds[1], bounds[0])[::-1]  # z, y, x
    depths = [
        float(np.percentile(density.mean(axis=axis, dtype=np.float64), 95)) * size[axis]
        for axis in range(3)
    ]
    deepest = max(depths)
    return float(f"{DEPTH / deepest:.2g}") if deepest > 0.0 else 1.0
