"""Bounding boxes of scenes along axes other than the world's."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..maths.chunks import chunks
from ..maths.transforms import box_along
from .checks import F64
from .mesh import Mesh, geometry_bounds
from .scene import Scene

Box = tuple[F64, F64]


def meshes_along(meshes: Iterable[Mesh], axes: F64) -> Box | None:
    """Lower and upper corner, metres along `axes` (3, 3), rows, of all surfaces; None of none.

    Every vertex counts: the box is as tight as it can be.
    """
    return _joined([_mesh_along(mesh, axes) for mesh in meshes])


def bounds_along(scene: Scene, axes: F64) -> Box:
    """`Scene.bounds` along `axes` (3, 3), rows, as tight as it can be.

    The boxes of a scene's meshes are those of their own axes, and loose where they are turned.
    """
    boxes = [_mesh_along(mesh, axes) for mesh in scene.meshes]
    for volume in scene.volumes:
        # A volume is a box of its own, placed by a matrix.
        placed = volume.world_from_volume
        low, high = box_along(axes @ placed[:3, :3], *volume.bounds)
        offset = axes @ placed[:3, 3]
        boxes.append((low + offset, high + offset))
    return _joined(boxes) or box_along(axes, *scene.bounds)


def whole_bounds_along(scene: Scene, axes: F64) -> Box:
    """`Scene.whole_bounds` along `axes` (3, 3), rows."""
    if scene.animation is None:
        return bounds_along(scene, axes)
    # What does not move is the same mesh at all times.
    found: dict[int, tuple[Mesh, Box]] = {}
    boxes = [bounds_along(scene, axes)]
    for moment in scene.animation.moments(scene):
        for mesh in moment.meshes:
            if id(mesh) not in found:
                found[id(mesh)] = (mesh, _mesh_along(mesh, axes))
    boxes += [box for _, box in found.values()]
    return _joined(boxes) or boxes[0]


def _mesh_along(mesh: Mesh, axes: F64) -> Box:
    linear = axes @ mesh.world_from_object[:3, :3]
    offset = axes @ mesh.world_from_object[:3, 3]
    geometry = mesh.geometry
    if (np.count_nonzero(linear, axis=1) <= 1).all():
        # The geometry's own box stays one.
        low, high = box_along(linear, *geometry_bounds(geometry))
        return low + offset, high + offset
    boxes: list[Box] = []
    # Else each vertex that a triangle uses is turned, some triangles at a time.
    for part in chunks(len(geometry.indices)):
        used = np.unique(geometry.indices[part])
        placed = geometry.positions[used].astype(np.float64) @ linear.T + offset
        boxes.append((placed.min(axis=0), placed.max(axis=0)))
    return _joined(boxes) or mesh.world_bounds


def _joined(boxes: list[Box]) -> Box | None:
    if not boxes:
        return None
    lows, highs = zip(*boxes, strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)
