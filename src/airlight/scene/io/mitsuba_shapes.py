"""Mitsuba's shapes as triangles."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError, nearest
from ..checks import F64
from ..mesh import Geometry
from .mitsuba_nodes import Node
from .mitsuba_textures import Source, color_attribute

ROUND_STEPS = 96  # around a sphere, a cylinder or a disk

# Mitsuba's own cube: 24 vertices of 8 corners (bit k of a corner: side along axis k).
_CUBE_CORNERS = [1, 5, 4, 0, 3, 2, 6, 7, 1, 3, 7, 5, 5, 7, 6, 4, 4, 6, 2, 0, 3, 1, 0, 2]
_CUBE_NORMALS = [(0, -1, 0), (0, 1, 0), (1, 0, 0), (0, 0, 1), (-1, 0, 0), (0, 0, -1)]


@dataclass(frozen=True, eq=False)
class Placed:
    """A geometry with its place; what a shape consists of."""

    geometry: Geometry
    world_from_object: F64


def shape_geometries(node: Node, source: Source) -> list[Placed]:
    """The triangles of a shape; none, and a note, for a kind that is not read.

    Raises SceneError for a kind that Mitsuba does not have, and for files that cannot be read.
    """
    if node.kind in ("obj", "ply", "serialized"):
        return _from_file(node, source)
    if node.kind == "sdfgrid":
        return [_sdf_grid(node, source)]
    # Kinds that Mitsuba has are left out with a note, others are mistakes.
    if node.kind not in _MAKERS:
        if node.kind not in _LEFT_OUT:
            raise SceneError(
                f"{node} is no shape of Mitsuba's",
                where=source.path,
                remedy=nearest(node.kind, [*_MAKERS, *_LEFT_OUT, *_OF_FILES]),
            )
        source.note(f"{node} is left out: shapes of this kind are not read")
        return []
    geometry = _unit_shape(node.kind, bool(node.get("flip_normals", False)))
    return [Placed(geometry, shape_matrix(node) @ _local(node))]


@functools.cache
def _unit_shape(kind: str, is_turned: bool) -> Geometry:
    """The triangles that all shapes of a kind share: only their places differ."""
    geometry = _MAKERS[kind]()
    return _turned(geometry) if is_turned else geometry


def shape_matrix(node: Node) -> F64:
    """Where a shape, or the grid of a volume, says it stands."""
    matrix = node.get("to_world")
    return np.eye(4) if matrix is None else np.asarray(matrix, dtype=np.float64)


def _local(node: Node) -> F64:
    """center and radius of a sphere, p0, p1 and radius of a cylinder, as a matrix."""
    matrix = np.eye(4)
    if node.kind == "sphere":
        matrix[:3, :3] *= float(node.get("radius", 1.0))
        matrix[:3, 3] = node.get("center", (0.0, 0.0, 0.0))
    elif node.kind == "cylinder":
        # The axis becomes the third column, two vectors of the radius across it the others.
        p0 = np.array(node.get("p0", (0.0, 0.0, 0.0)))
        axis = np.array(node.get("p1", (0.0, 0.0, 1.0))) - p0
        radius, length = float(node.get("radius", 1.0)), float(np.linalg.norm(axis))
        if length == 0.0:
            raise SceneError(f"{node} has no length")
        z = axis / length
        # A vector across it, by the world's z, or by x where z is nearly along it.
        x = np.cross(z, (0.0, 0.0, 1.0) if abs(z[2]) < 0.9 else (1.0, 0.0, 0.0))
        x /= np.linalg.norm(x)
        matrix[:3, 0], matrix[:3, 1] = radius * x, radius * np.cross(z, x)
        matrix[:3, 2], matrix[:3, 3] = axis, p0
    return matrix


def _from_file(node: Node, source: Source) -> list[Placed]:
    # Meshes of the file, and which way up their textures lie in it.
    path = source.file(node)
    if node.kind == "ply":
        from .mitsuba_ply import read_ply

        parts = [Placed(read_ply(path, color_attribute(node)), np.eye(4))]
        flip_v = bool(node.get("flip_tex_coords", False))
    elif node.kind == "serialized":
        from .mitsuba_serialized import read_serialized

        parts = [Placed(read_serialized(path, int(node.get("shape_index", 0))), np.eye(4))]
        flip_v = bool(node.get("flip_tex_coords", False))
    else:
        from .obj import load_obj

        loaded = load_obj(path)
        parts = [Placed(mesh.geometry, mesh.world_from_object) for mesh in loaded.meshes]
        # `load_obj` has flipped v already, as Mitsuba does unless it is told not to.
        flip_v = not node.get("flip_tex_coords", True)
    # What the node changes of them.
    faceted, turned = node.get("face_normals", False), node.get("flip_normals", False)
    to_world = shape_matrix(node)
    placed = []
    for part in parts:
        geometry = part.geometry
        if flip_v and geometry.uvs is not None:
            geometry = replace(geometry, uvs=geometry.uvs * (1, -1) + (0, 1))
        geometry = _faceted(geometry) if faceted else geometry
        geometry = _turned(geometry) if turned else geometry
        placed.append(Placed(geometry, to_world @ part.world_from_object))
    return placed


def _sdf_grid(node: Node, source: Source) -> Placed:
    from .mitsuba_sdf import read_sdf_grid

    geometry = read_sdf_grid(source.file(node), str(node.get("normals", "smooth")))
    is_turned = bool(node.get("flip_normals", False))
    return Placed(_turned(geometry) if is_turned else geometry, shape_matrix(node))


def _turned(geometry: Geometry) -> Geometry:
    """Inside out."""
    assert geometry.normals is not None
    return replace(
        geometry,
        indices=np.ascontiguousarray(geometry.indices[:, ::-1]),
        normals=-geometry.normals,
    )


def _faceted(geometry: Geometry) -> Geometry:
    """Every triangle with its own vertices and its own normal."""
    corners = geometry.indices.ravel()
    positions = geometry.positions[corners]
    a, b, c = (positions[k::3].astype(np.float64) for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return Geometry(
        positions,
        np.arange(len(corners), dtype=np.uint32).reshape(-1, 3),
        normals=np.repeat(normals, 3, axis=0).astype(np.float32),
        uvs=None if geometry.uvs is None else geometry.uvs[corners],
        colors=None if geometry.colors is None else geometry.colors[corners],
    )


def _cube() -> Geometry:
    # Six faces of four corners, two triangles each.
    corner = np.array(_CUBE_CORNERS)
    positions = np.stack([corner & 1, corner >> 1 & 1, corner >> 2 & 1], axis=1) * 2 - 1
    first = 4 * np.arange(6)[:, None, None]
    indices = (first + np.array([[0, 1, 2], [3, 0, 2]])).reshape(-1, 3)
    uvs = np.tile([(0, 1), (1, 1), (1, 0), (0, 0)], (6, 1))
    normals = np.repeat(_CUBE_NORMALS, 4, axis=0)
    return _geometry(positions, indices, normals, uvs)


def _rectangle() -> Geometry:
    positions = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])
    normals = np.tile((0, 0, 1), (4, 1))
    uvs = (positions[:, :2] + 1) / 2
    return _geometry(positions, np.array([[0, 1, 2], [0, 2, 3]]), normals, uvs)


def _sphere() -> Geometry:
    """u around +Z from +X, v from +Z (0) to -Z (1)."""
    u, v = _grid(ROUND_STEPS, ROUND_STEPS // 2)
    normals = np.stack(
        [
            np.sin(np.pi * v) * np.cos(2 * np.pi * u),
            np.sin(np.pi * v) * np.sin(2 * np.pi * u),
            np.cos(np.pi * v),
        ],
        axis=1,
    )
    # Triangles at the poles that have no area are left out.
    indices = _cells(ROUND_STEPS, ROUND_STEPS // 2)
    area = np.linalg.norm(
        np.cross(
            normals[indices[:, 1]] - normals[indices[:, 0]],
            normals[indices[:, 2]] - normals[indices[:, 0]],
        ),
        axis=1,
    )
    return _geometry(normals, indices[area > 1e-12], normals, np.stack([u, v], axis=1))


def _cylinder() -> Geometry:
    """Open, along z from 0 to 1; u around it, v along it."""
    u, v = _grid(ROUND_STEPS, 1)
    angle = 2 * np.pi * (u % 1.0)  # the seam's two sides meet
    normals = np.stack([np.cos(angle), np.sin(angle), 0 * u], axis=1)
    positions = normals + np.stack([0 * v, 0 * v, v], axis=1)
    uvs = np.stack([u, v], axis=1)
    return _geometry(positions, _cells(ROUND_STEPS, 1)[:, ::-1], normals, uvs)


def _disk() -> Geometry:
    """Faces +Z; u from the centre outwards, v around."""
    # Rows from the centre outwards: the first has all its points at the centre.
    around, outwards = _grid(ROUND_STEPS, 1)
    angle = 2 * np.pi * around
    positions = outwards[:, None] * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    # Of each cell the triangle with two corners on the rim; the other one has no area.
    indices = _cells(ROUND_STEPS, 1)
    indices = indices[(indices >= ROUND_STEPS + 1).sum(axis=1) == 2]
    normals = np.tile((0, 0, 1), (len(positions), 1))
    return _geometry(positions, indices, normals, np.stack([outwards, around], axis=1))


def _grid(columns: int, rows: int) -> tuple[F64, F64]:
    """(u, v) of a lattice of (rows + 1) x (columns + 1) points, flat."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    return u.ravel(), v.ravel()


def _cells(columns: int, rows: int) -> NDArray[np.int64]:
    """Two triangles a cell, counter-clockwise seen from where v grows downwards, u rightwards."""
    j, i = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a = j * (columns + 1) + i
    b = a + columns + 1
    cells = np.stack([a, b, b + 1, a, b + 1, a + 1], axis=-1)
    return cells.reshape(-1, 3)


def _geometry(positions: F64, indices: NDArray[Any], normals: F64, uvs: F64) -> Geometry:
    return Geometry(
        np.asarray(positions, np.float32),
        np.ascontiguousarray(indices).astype(np.uint32),
        normals=np.asarray(normals, np.float32),
        uvs=np.asarray(uvs, np.float32),
    )


_MAKERS: dict[str, Callable[[], Geometry]] = {
    "cube": _cube,
    "rectangle": _rectangle,
    "sphere": _sphere,
    "cylinder": _cylinder,
    "disk": _disk,
}
_OF_FILES = ("obj", "ply", "serialized", "sdfgrid")
_LEFT_OUT = (
    "bsplinecurve",
    "linearcurve",
    "ellipsoids",
    "ellipsoidsmesh",
    "hair",
    "heightfield",
)
