"""Lattices whose cells end at walls.

A wall closes the faces of cells that are nearest to it: a hall 5.06 cells high has five rows of
cells, or six where its floor and its ceiling lie otherwise, and light fills what the sixth holds.
So cells are made up to a tenth larger and the lattice is moved by parts of a cell, so that as much
wall area as can be lies on faces: of all sizes and places the one that has the least mean square
distance, in cells, from walls to faces. What is no wall along the lattice's axes has no say.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..maths.arrays import F64
from ..maths.chunks import chunks
from ..maths.transforms import placed_points, triple
from ..scene.mesh import Mesh
from .placement import Axes, Placement, tiled

Walls = tuple[tuple[F64, F64], ...]
"""For each axis the coordinates (n,), metres, of what faces along it, and its areas (n,), m^2."""

_FACING = np.cos(np.radians(2.0))
_LARGEST, _SIZES = 1.1, 11
"""Times as large cells at most, and how many sizes are tried."""
_WORTH = 0.05
"""Cells squared: where more than that is left walls lie anywhere, and lattices stay as they are."""
_OFFSETS = 64
"""Places within a cell that are tried."""
_BINS = 64
"""Of a cell: walls so close to each other are one."""
_PRICE = 0.1
"""Cells squared: what cells twice as large must take off the mean square distance, which is
1/12 where walls lie anywhere."""


def walls_along(meshes: tuple[Mesh, ...], axes: Axes) -> Walls:
    """What of all surfaces faces along `axes`, two degrees off at most.

    It depends on planes and areas alone, not on how surfaces are cut or which side faces where.
    """
    turn = np.array(axes)
    found: list[list[F64]] = [[np.zeros((2, 0))] for _ in range(3)]
    for mesh in meshes:
        placed, geometry = mesh.world_from_object, mesh.geometry
        for part in chunks(len(geometry.indices)):
            corners = geometry.positions[geometry.indices[part]].astype(np.float64)
            corners = placed_points(corners, placed) @ turn.T
            normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            areas = np.linalg.norm(normals, axis=1)
            for axis in range(3):
                faces = np.abs(normals[:, axis]) > _FACING * areas
                place = corners[faces, :, axis].mean(axis=1)
                found[axis].append(np.stack([place, areas[faces]]))
    whole = [np.concatenate(parts, axis=1) for parts in found]
    return tuple((places, areas) for places, areas in whole)


def at_walls(placement: Placement, low: F64, high: F64, walls: Walls) -> Placement:
    """A lattice over the box low..high (metres along its axes) that ends at `walls`.

    `placement` is what it is without them, and what comes of no walls; its cells are the smallest.
    """
    # All counts from the first wall along each axis, so that it does not matter where the scene
    # lies, nor what the box has beside walls.
    inside = [_inside(*walls[axis], low[axis], high[axis], placement.cell) for axis in range(3)]
    first = np.array([places.min(initial=high[k]) for k, (places, _) in enumerate(inside)])
    low, high = low - first, high - first
    inside = [_binned(p - first[k], areas, placement.cell) for k, (p, areas) in enumerate(inside)]
    area = sum(float(areas.sum()) for _, areas in inside)
    if area <= 0.0:
        return placement
    least, best = min(_WORTH, _off(placement, first, inside) / area), placement
    for larger in np.linspace(0.0, _LARGEST - 1.0, _SIZES):
        cell = float((1.0 + larger) * placement.cell)
        found = [_offset(places, areas, cell) for places, areas in inside]
        off = sum(left for _, left in found) / area + _PRICE * larger
        made = _around(placement, (low, high), first, cell, np.array([at for at, _ in found]))
        if off < least - 1e-9 and max(made.count) <= max(placement.count):
            least, best = off, made
    return best


def _inside(places: F64, areas: F64, low: float, high: float, cell: float) -> tuple[F64, F64]:
    """Walls of the box."""
    hair = 1e-3 * cell
    found = (places > low - hair) & (places < high + hair)
    return places[found], areas[found]


def _binned(places: F64, areas: F64, cell: float) -> tuple[F64, F64]:
    """Walls from 0 on, those that are close to each other in one: mean places, and areas."""
    bins = np.round(places / cell * _BINS).astype(np.int64)
    total = np.asarray(np.bincount(bins, areas), dtype=np.float64)
    mean = np.bincount(bins, areas * places) / np.maximum(total, 1e-300)
    return mean[total > 0.0], total[total > 0.0]


def _off(placement: Placement, first: F64, walls: list[tuple[F64, F64]]) -> float:
    """The sum of area by distances squared, in cells, of `walls` from the faces of a lattice."""
    total = 0.0
    for begin, (places, areas) in zip(placement.origin - first, walls, strict=True):
        off = (places - begin) / placement.cell
        total += float(areas @ (off - np.round(off)) ** 2)
    return total


def _offset(places: F64, areas: F64, cell: float) -> tuple[float, float]:
    """Where faces lie, in cells from 0 to 1, and the sum of area by distances squared of that."""
    if not len(places):
        return 0.0, 0.0
    offsets = np.arange(_OFFSETS) / _OFFSETS
    off = places[:, None] / cell - offsets
    off -= np.round(off)
    # The first of those that are as good, so that rounding does not choose.
    sums = areas @ off**2
    best = int((sums <= sums.min() + 1e-6 * areas.sum()).argmax())
    # As far on as walls are in the mean.
    more = float(areas @ off[:, best] / areas.sum())
    return float(offsets[best] + more), float(areas @ (off[:, best] - more) ** 2)


def _around(
    placement: Placement, box: tuple[F64, F64], origin: F64, cell: float, offsets: F64
) -> Placement:
    """The lattice of faces at `offsets` around a box, one cell to three beyond it.

    The box counts from the `origin`. Nearer to the lattice's border a wall would close no faces.
    """
    # Faces are numbered from the one at the offset; a hair, so that rounding adds no cells.
    begin, end = (corner / cell - offsets for corner in box)
    hair = 1e-6
    first, last = np.floor(begin - 1.0 + hair), np.ceil(end + 1.0 - hair)
    # Pairs of cells: one more where the margin is smaller.
    count = tiled((last - first).astype(np.int64))
    first -= (count - (last - first) > 0.5) & (begin - first < last - end - hair)
    moved = triple(origin + (first + offsets) * cell)
    return replace(placement, origin=moved, cell=cell, count=count)
