"""Mitsuba's `sdfgrid`: the surface where a grid of distances is zero, as triangles.

The grid fills the unit cube, its first and last points on the faces; distances are negative
inside. Mitsuba meets the trilinear field's zero; triangles of quarter cells are near it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import SceneError
from ...maths.arrays import F64
from ...maths.level_set import gradient_at, refined, smooth_gradient, zero_surface
from ...maths.voxels import trilinear
from ..mesh import Geometry
from .files import naming
from .vol import vol_values

_PARTS = 4
"""Cells of triangles along each of the grid's cells."""
_MOST_CELLS = 160
"""Along an axis, from which on they are no finer than the grid's."""


def read_sdf_grid(path: Path, normals: str) -> Geometry:
    """The surface of the distances in a .vol file; `normals` as Mitsuba has them, "smooth" between
    the grid's points or "analytic", those of the trilinear field. Raises SceneError."""
    values = vol_values(path)
    if values.shape[3] != 1 or min(values.shape[:3]) < 2:
        raise SceneError(
            f"has {values.shape[3]} channels and {values.shape[2]} x {values.shape[1]} x "
            f"{values.shape[0]} points, distances need one channel and two points along each axis",
            where=path,
        )
    if not np.isfinite(values).all():
        raise SceneError("has distances that are NaN or infinite", where=path)
    with naming(path):
        return sdf_geometry(values[..., 0].astype(np.float64), is_smooth=normals != "analytic")


def sdf_geometry(values: F64, *, is_smooth: bool = True) -> Geometry:
    """The surface in the unit cube where `values` (z, y, x) are zero. Raises SceneError."""
    parts = _PARTS if max(values.shape) * _PARTS <= _MOST_CELLS else 1
    points, triangles = zero_surface(refined(values, parts))
    if not len(triangles):
        raise SceneError("its distances are of one sign: there is no surface")
    points = points / parts
    if is_smooth:
        slopes = smooth_gradient(values)
        # Voxels stand half a voxel behind corners, which `trilinear` counts from; points on them.
        rises = np.stack([trilinear(slope, points + 0.5) for slope in slopes], axis=1)
    else:
        # The field's slope leaps from cell to cell: each triangle has its own corners.
        corners = points[triangles]
        inner = corners + 1e-3 * (corners.mean(axis=1, keepdims=True) - corners)
        points, rises = corners.reshape(-1, 3), gradient_at(values, inner.reshape(-1, 3))
        triangles = np.arange(len(points)).reshape(-1, 3)
    # From cells to the unit cube, whose cells need not be cubes.
    cells = np.array(values.shape[::-1]) - 1.0
    normals = rises * cells
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return Geometry(
        (points / cells).astype(np.float32),
        triangles.astype(np.uint32),
        normals=normals.astype(np.float32),
    )
