"""The points of a scene that bound it, few enough to be looked at from everywhere.

Of a large mesh these are its furthest points in DIRECTIONS directions. A corner that is furthest
between those alone is blunt: it stands out by less than 8 % of its distance to its neighbours
(a quarter of the directions' spacing, .31), far within the margin that an image has.
"""

from __future__ import annotations

import numpy as np

from ...maths.chunks import chunks
from ...maths.transforms import placed_points
from ..checks import F64
from ..mesh import Geometry
from ..scene import Scene
from .probe import sphere_directions

DIRECTIONS = 128
_AT_ONCE = 512  # so small a product is made by one thread, which does not wait for others


def outline(scene: Scene) -> F64:
    """Points (N, 3) of the scene's meshes, metres, less what is cut out whole."""
    found: dict[int, F64] = {}
    parts = [np.zeros((0, 3))]
    for mesh in scene.meshes:
        if mesh.material.alpha < mesh.material.alpha_cutoff:
            continue
        # Shapes that stand in many places are looked through once.
        key = id(mesh.geometry)
        if key not in found:
            found[key] = _furthest(mesh.geometry)
        matrix = mesh.world_from_object
        parts.append(placed_points(found[key], matrix))
    return np.concatenate(parts)


def _furthest(geometry: Geometry) -> F64:
    """The vertices of triangles, all of a few, else the furthest in each direction."""
    used = np.zeros(len(geometry.positions), bool)
    used[geometry.indices.ravel()] = True
    points = geometry.positions[used]
    if len(points) <= DIRECTIONS:
        return np.asarray(points, np.float64)
    directions = sphere_directions(DIRECTIONS).astype(np.float32)
    best, reach = np.zeros(DIRECTIONS, np.int64), np.full(DIRECTIONS, -np.inf)
    for part in chunks(len(points), _AT_ONCE):
        along = directions @ np.ascontiguousarray((points[part] - points[0]).T)
        furthest = along.argmax(axis=1)
        value = along[np.arange(DIRECTIONS), furthest]
        best = np.where(value > reach, part.start + furthest, best)
        reach = np.maximum(value, reach)
    return np.asarray(points[np.unique(best)], np.float64)
