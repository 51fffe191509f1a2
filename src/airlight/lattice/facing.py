"""The axes of a lattice: those that the scene's walls face.

Blockers are counted on faces of cells. A wall along an axis is one plane of faces; an oblique wall
is a staircase, which blocks light that runs along it and shows in the irradiance of surfaces. So
the axes are those to which most area of all surfaces is perpendicular, if there are such.
"""

from __future__ import annotations

import numpy as np

from ..maths.arrays import F64
from ..maths.chunks import chunks
from ..maths.transforms import cofactors, triple
from ..scene.mesh import Geometry, Mesh
from .placement import STRAIGHT, Axes

_NEAR = np.cos(np.radians(2.0))
"""Normals so near to an axis face along it."""
_OUT_OF_PLANE = np.sin(np.radians(2.0)) + 1e-9
"""The cosine to an axis of what is as near to one across it."""
_SAME = 2e-4
"""Radians: over 256 cells a twentieth of one. Axes so near to the world's are the world's."""
_GAIN = 0.05
"""Of all area: what must face along the axes more than along the world's, lest they turn."""
_MOST = 24
_NARROW = np.cos(np.radians(0.1))
_FINE, _COARSE = 4096, 64  # normals are summed that agree in units of one over these


def wall_axes(meshes: tuple[Mesh, ...]) -> Axes:
    """Unit vectors along which most area of `meshes` faces; the world's where that gains little.

    Their names and signs are those nearest to the world's, as a right-handed frame. They depend on
    areas alone: not on how surfaces are cut into triangles, instances or files, nor on which side
    triangles face.
    """
    # Area by direction, coarse for candidates, fine for the axes that come of them.
    fine = _facing(meshes)
    if not len(fine):
        return STRAIGHT
    normals, areas = _parted(_summed(fine, _COARSE))
    straight = np.eye(3)
    # The world's axes, unless others have a good deal more of the area.
    best, most = straight, _share(straight, normals, areas) + _GAIN * areas.sum()
    peaks = [_settled(_refined(peak, fine)) for peak in _peaks(normals, areas)]
    # A frame has one axis from a peak, and the next from another or from the world.
    for first in peaks:
        # What is neither along the first axis nor across it faces along none of the three.
        cosine = np.abs(normals @ first)
        along, across = cosine > _NEAR, cosine < _OUT_OF_PLANE
        kept = normals[along | across], areas[along | across]
        for second in (*peaks, *straight):
            rest = second - (second @ first) * first
            if (length := np.linalg.norm(rest)) < 0.1:
                continue
            frame = _frame(first, rest / length)
            share = _share(frame, *kept)
            if share > most * (1.0 + 1e-9):
                best, most = frame, share
    x, y, z = (triple(axis) for axis in best)
    return (x, y, z)


def _facing(meshes: tuple[Mesh, ...]) -> F64:
    """(n, 3): normals times areas, m^2, of all surfaces, summed where they agree."""
    own: dict[int, F64] = {}
    found = [np.zeros((0, 3))]
    # The cofactors of a transform turn and scale area vectors as it does surfaces.
    linear = np.array([mesh.world_from_object[:3, :3] for mesh in meshes]).reshape(-1, 3, 3)
    turns = np.ascontiguousarray(cofactors(linear).swapaxes(1, 2))
    for mesh, turn in zip(meshes, turns, strict=True):
        key = id(mesh.geometry)
        if key not in own:
            own[key] = _area_vectors(mesh.geometry)
        found.append(own[key] @ turn)
    return _summed(np.concatenate(found), _FINE)


def _area_vectors(geometry: Geometry) -> F64:
    """(n, 3): normals times areas, m^2, summed where they agree; object space."""
    found = []
    for part in chunks(len(geometry.indices)):
        corners = geometry.positions[geometry.indices[part]].astype(np.float64)
        edges = corners[:, 1:] - corners[:, :1]
        found.append(_summed(0.5 * np.cross(edges[:, 0], edges[:, 1]), _FINE))
    return _summed(np.concatenate(found), _FINE)


def _parted(vectors: F64) -> tuple[F64, F64]:
    """Split area vectors into unit normals (n, 3) and areas (n,), m^2."""
    areas = np.linalg.norm(vectors, axis=1)
    return vectors / areas[:, None], areas


def _summed(vectors: F64, steps: int) -> F64:
    """Vectors (n, 3), summed where directions agree in steps of 1 / `steps`.

    Opposite directions count as one.
    """
    # A direction without area says nothing.
    length = np.linalg.norm(vectors, axis=1)
    vectors, length = vectors[length > 0.0], length[length > 0.0]
    # The sign of the largest component says which of the two directions it is.
    largest = np.abs(vectors).argmax(axis=1)
    vectors = vectors * np.sign(vectors[np.arange(len(vectors)), largest])[:, None]

    # Directions that round to the same point of a grid are one.
    bins = np.round(vectors / length[:, None] * steps).astype(np.int64) + steps
    side = 2 * steps + 1
    _, which = np.unique((bins[:, 0] * side + bins[:, 1]) * side + bins[:, 2], return_inverse=True)
    sums = [np.bincount(which.ravel(), weights=component) for component in vectors.T]
    return np.stack(sums, axis=1)


def _peaks(normals: F64, areas: F64) -> list[F64]:
    """Directions that much area faces, those with the most area first."""
    left, found = areas.copy(), []
    # Each takes with it all area that faces nearly its way, until the rest would gain little.
    for _ in range(_MOST):
        found.append(normals[int(left.argmax())])
        left[np.abs(normals @ found[-1]) > _NEAR] = 0.0
        if left.sum() <= _GAIN * areas.sum():
            break
    return found


def _refined(direction: F64, vectors: F64) -> F64:
    """The mean direction of the area near `direction`; of a plane, if that has most of it."""
    # All that faces nearly along it, on one side.
    near = vectors[np.abs(vectors @ direction) > _NEAR * np.linalg.norm(vectors, axis=1)]
    near = near * np.sign(near @ direction)[:, None]
    # A plane's own normal, so that rounding by bins leaves no trace; else the mean.
    normals, areas = _parted(near)
    narrow = np.abs(normals @ normals[int(areas.argmax())]) > _NARROW
    is_plane = areas[narrow].sum() > 0.5 * areas.sum()
    mean = near[narrow].sum(axis=0) if is_plane else near.sum(axis=0)
    return np.asarray(mean / np.linalg.norm(mean), np.float64)


def _settled(direction: F64) -> F64:
    """The direction, or the world's axis where they hardly differ."""
    axis = int(np.abs(direction).argmax())
    nearest = np.eye(3)[axis] * np.sign(direction[axis])
    return nearest if np.linalg.norm(direction - nearest) < _SAME else direction


def _frame(first: F64, second: F64) -> F64:
    """(3, 3): the three directions as rows of a turn, each by the world's axis that is nearest."""
    directions = np.stack([first, second, np.cross(first, second)])
    rows = np.zeros((3, 3))
    free = [0, 1, 2]
    # The largest cosine first: floors keep their name.
    for cosine in np.argsort(-np.abs(directions), axis=None):
        which, axis = divmod(int(cosine), 3)
        if which in free and not rows[axis].any():
            rows[axis] = directions[which] * np.sign(directions[which, axis])
            free.remove(which)
    # A turn, no mirror: the axis that is least like the world's changes its sign.
    if np.linalg.det(rows) < 0.0:
        least = int(np.abs(np.diag(rows)).argmin())
        rows[least] *= -1.0
    return rows + 0.0  # no negative zeros


def _share(frame: F64, normals: F64, areas: F64) -> float:
    """Area, m^2, that faces along one of the frame's axes; less of what is a little aslant."""
    # Full at the axis, none at two degrees from it.
    nearest = np.abs(normals @ frame.T).max(axis=1)
    off = np.arccos(np.minimum(nearest, 1.0)) / np.arccos(_NEAR)
    return float((areas * np.maximum(1.0 - off, 0.0)).sum())
