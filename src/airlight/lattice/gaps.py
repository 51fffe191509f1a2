"""How far apart the surfaces of a scene are, which says how small a lattice's cells must be.

Cells follow from the box around a scene, which a ground larger than all that stands on it makes
large. Light between two surfaces needs cells of its own: where they share one, each is lit as the
other is. So gaps are measured along the lattice's axes, between samples of all surfaces.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import F64
from ..maths.transforms import placed_points
from ..scene.mesh import Mesh
from .placement import Axes
from .surfels import samples_of, triangle_areas

FEWEST_CELLS = 2.0
"""Cells across a narrow gap that one lattice must give it: one for each surface on its sides."""
CELLS_A_GAP = 4.0
"""Cells that the finest gives it where lattices are nested."""
MOST = 4
"""Lattices that are nested without being asked for."""
_NARROW = 0.2
"""Of all air in gaps: what lies in those that count as narrow. By air, not by area: leaves, books
and what lies under furniture have much surface and little air between them."""
_SAMPLES = 20_000
_COLUMNS = 64
"""Columns along the longest side, in which surfaces face each other."""
_SHEET = 0.15
"""Widths of a column within which samples are of one surface."""


def nested_count(gap_m: float, cell_m: float, ratio: float) -> int:
    """How many lattices to nest, so that the finest has `CELLS_A_GAP` cells across `gap_m`.

    One does where its own cells, `cell_m` wide, are `FEWEST_CELLS` across the gap; each finer
    lattice's are smaller by `ratio`. Between 1 and `MOST`.
    """
    # The log of what is missing, in steps of the ratio.
    if gap_m >= FEWEST_CELLS * cell_m:
        return 1
    finer = np.log(CELLS_A_GAP * cell_m / gap_m) / np.log(ratio)
    return int(min(1 + np.ceil(finer - 1e-9), MOST))


def narrow_gap(meshes: tuple[Mesh, ...], axes: Axes) -> float:
    """The width, metres, of gaps between surfaces than which a fifth of the air in them has less.

    Gaps are measured along `axes`; what lies between the back of one surface and the back of the
    next is inside a body and no gap. Infinite where no surface faces another.
    """
    points, normals = _samples(meshes, np.array(axes))
    longest = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    if longest <= 0.0:
        return float(np.inf)
    # A slot is narrow along one axis alone: gaps along all three count together.
    found = [_gaps_along(points, normals, axis, longest / _COLUMNS) for axis in range(3)]
    width, air = np.concatenate(found, axis=1)
    if not len(width):
        return float(np.inf)
    # The quantile of widths, each weighted by the air in its gap.
    order = np.argsort(width)
    share = np.cumsum(air[order])
    return float(width[order][np.searchsorted(share, _NARROW * share[-1])])


def _samples(meshes: tuple[Mesh, ...], turn: F64) -> tuple[F64, F64]:
    """Points (n, 3) of all surfaces, metres, and normals times the areas that they stand for.

    Both are along the rows of `turn`. About `_SAMPLES` by area, at least one of each mesh.
    """
    # Samples by area, as surfels are drawn.
    areas = [triangle_areas(mesh) for mesh in meshes]
    total = max(float(sum(a.sum() for a in areas)), 1e-30)
    points, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for mesh, own in zip(meshes, areas, strict=True):
        if own.sum() <= 0.0:
            continue
        triangle, weights = samples_of(own, max(1, round(_SAMPLES * float(own.sum()) / total)))
        # In the world, then along the axes.
        geometry, placed = mesh.geometry, mesh.world_from_object
        corners = geometry.positions[geometry.indices[triangle]].astype(np.float64)
        corners = placed_points(corners, placed)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)

        # Points and area normals in the lattice's frame.
        points.append(np.einsum("nk,nkc->nc", weights, corners) @ turn.T)
        normals.append(normal / length * (own.sum() / len(triangle)) @ turn.T)
    return np.concatenate(points), np.concatenate(normals)


def _gaps_along(points: F64, normals: F64, axis: int, column_m: float) -> F64:
    """(2, n): widths, m, and air, m^3, of the gaps along an axis, column by column."""
    # Samples of surfaces that face along the axis, sorted in their columns.
    faces = np.abs(normals).argmax(axis=1) == axis
    low = np.delete(points.min(axis=0), axis)
    points, facing = points[faces], normals[faces, axis]
    index = np.floor((np.delete(points, axis, 1) - low) / column_m)
    column: NDArray[np.int64] = (index @ (1.0, 2.0 * _COLUMNS)).astype(np.int64)
    order = np.lexsort((points[:, axis], column))
    column, place, facing = column[order], points[order, axis], facing[order]
    # Samples that are close together are one surface, which faces as most of its area does.
    is_new = np.diff(column, prepend=-1) != 0
    is_new[1:] |= np.diff(place) > _SHEET * column_m
    which, starts = np.cumsum(is_new) - 1, column[is_new]
    place = np.bincount(which, place) / np.maximum(np.bincount(which), 1)
    area, side = np.bincount(which, np.abs(facing)), np.bincount(which, facing)
    # From one surface to the next of its column, but for the inside of bodies.
    is_gap = (starts[1:] == starts[:-1]) & ~((side[:-1] < 0.0) & (side[1:] > 0.0))
    width = np.diff(place)[is_gap]
    return np.stack([width, width * np.minimum(area[1:], area[:-1])[is_gap]])
