"""Triangles, and where they stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..maths.chunks import chunks
from ..maths.transforms import normal_matrix, placed_points
from . import checks
from .checks import F32, F64
from .material import DEFAULT_MATERIAL, Material


@dataclass(frozen=True, eq=False)
class Geometry:
    """An indexed triangle mesh in its own space.

    `positions` (V, 3) float32 metres; `indices` (T, 3) uint32, counter-clockwise seen from the
    front; `normals` (V, 3) float32, made smooth-shaded from the triangles where missing;
    `uvs` (V, 2) float32, v downwards from the image's top row; `colors` (V, 4) float32 linear,
    multiplied into the base colour; `tangents` (V, 4) float32, by which normal maps lie: the
    direction of a map's red, as far as it is at right angles to the normal, and 1 or -1, the side
    of its green, as glTF has them. Without them, or where one is 0, maps lie by `uvs`.
    Raises SceneError for NaN, no triangles, bad indices.
    """

    positions: F32
    indices: NDArray[np.uint32]
    normals: F32 | None = None
    uvs: F32 | None = None
    colors: F32 | None = None
    tangents: F32 | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        # Positions and indices first: all others have to match their number.
        positions = checks.array(
            self.positions, "vertex positions", shape=(None, 3), dtype=np.float32
        )
        checks.at_most(positions, checks.MOST, "vertex positions")
        indices = _checked_indices(self.indices, len(positions))
        put(self, "positions", positions)
        put(self, "indices", indices)
        # Without normals the surface is smooth.
        normals = self.normals
        if normals is None:
            normals = smooth_normals(positions, indices)
        count = len(positions)
        put(self, "normals", checks.array(normals, "normals", shape=(count, 3), dtype=np.float32))
        # What a vertex may have beside.
        for name, width in (("uvs", 2), ("colors", 4), ("tangents", 4)):
            value = getattr(self, name)
            if value is not None:
                put(self, name, checks.array(value, name, shape=(count, width), dtype=np.float32))


@dataclass(frozen=True, eq=False)
class Mesh:
    """A geometry with one material, placed by `world_from_object` (4x4, affine).

    `name` is for messages and files.

    A mirroring placement keeps the front: it is counter-clockwise in the geometry's own space.
    """

    geometry: Geometry
    material: Material = DEFAULT_MATERIAL
    world_from_object: F64 = field(default_factory=lambda: np.eye(4))
    name: str = ""

    def __post_init__(self) -> None:
        checks.instance(self.geometry, f"geometry of mesh '{self.name}'", Geometry)
        checks.instance(self.material, f"material of mesh '{self.name}'", Material)
        matrix = checks.affine(self.world_from_object, f"transform of mesh '{self.name}'")
        checks.at_most(matrix, checks.MOST, f"transform of mesh '{self.name}'")
        object.__setattr__(self, "world_from_object", matrix)

    @property
    def world_positions(self) -> F64:
        """Its vertices (V, 3), metres in the world."""
        return placed_points(self.geometry.positions.astype(np.float64), self.world_from_object)

    @property
    def world_bounds(self) -> tuple[F64, F64]:
        """Lower and upper corner of the axis-aligned box around the placed mesh, metres."""
        (box,) = world_boxes([self])
        return box[0], box[1]


def is_mirrored(mesh: Mesh) -> bool:
    """Whether the mesh's transform turns counter-clockwise triangles clockwise."""
    return bool(np.linalg.det(mesh.world_from_object[:3, :3]) < 0.0)


def in_world(mesh: Mesh) -> Geometry:
    """The mesh's geometry where it stands, normals out of its front."""
    geometry, matrix = mesh.geometry, mesh.world_from_object
    # Normals of a transform without volume stay as they were.
    assert geometry.normals is not None
    turned = geometry.normals @ normal_matrix(matrix)[:3, :3].T
    length = np.linalg.norm(turned, axis=1, keepdims=True)
    normals = np.where(length > 0.0, turned / np.maximum(length, 1e-300), geometry.normals)
    # A mirroring transform turns triangles over: wound the other way, they face as before.
    indices, tangents, side = geometry.indices, geometry.tangents, 1.0
    if is_mirrored(mesh):
        indices, side = indices[:, [0, 2, 1]], -1.0
    if tangents is not None:
        along = tangents[:, :3] @ matrix[:3, :3].T
        tangents = np.concatenate([along, side * tangents[:, 3:]], axis=1).astype(np.float32)
    return replace(
        geometry,
        positions=placed_points(geometry.positions, matrix).astype(np.float32),
        indices=indices,
        normals=normals.astype(np.float32),
        tangents=tangents,
    )


_CORNERS = np.array(np.meshgrid((0, 1), (0, 1), (0, 1))).reshape(3, 8).T


def world_boxes(meshes: Sequence[Mesh]) -> F64:
    """`world_bounds` of many meshes, (M, 2, 3)."""
    # The eight corners of each geometry's box, placed, and the box around those.
    boxes = np.array([geometry_bounds(mesh.geometry) for mesh in meshes]).reshape(-1, 2, 3)
    matrices = np.array([mesh.world_from_object for mesh in meshes]).reshape(-1, 4, 4)
    corners = boxes[:, _CORNERS, np.arange(3)]
    placed = corners @ matrices[:, :3, :3].swapaxes(1, 2) + matrices[:, None, :3, 3]
    return np.stack([placed.min(axis=1), placed.max(axis=1)], axis=1)


def geometry_bounds(geometry: Geometry) -> tuple[F64, F64]:
    """The geometry's own box, metres in its space; cached on the (immutable) geometry."""
    known = geometry.__dict__.get("_bounds")
    # Vertices that no triangle uses are not seen, and do not count.
    if known is None:
        is_used = np.zeros(len(geometry.positions), dtype=bool)
        is_used[geometry.indices.ravel()] = True
        used = geometry.positions if is_used.all() else geometry.positions[is_used]
        known = (used.min(axis=0).astype(np.float64), used.max(axis=0).astype(np.float64))
        object.__setattr__(geometry, "_bounds", known)
    return cast(tuple[F64, F64], known)


def _checked_indices(indices: NDArray[np.uint32], vertex_count: int) -> NDArray[np.uint32]:
    raw = np.asarray(indices)
    if raw.size == 0:
        raise SceneError("mesh has no triangles")
    # Whole numbers, whatever type they have.
    if raw.dtype.kind not in "iu":
        numbers = checks.array(raw, "triangle indices", shape=(None, 3), dtype=np.float64)
        if (numbers != np.floor(numbers)).any():
            raise SceneError("triangle indices must be whole numbers")
        raw = numbers.astype(np.int64)
    # The least and the most index tell whether all are in range.
    if raw.min() < 0 or raw.max() >= vertex_count:
        raise SceneError(
            f"triangle index {int(raw.max() if raw.min() >= 0 else raw.min())} is out of range: "
            f"the mesh has {vertex_count} vertices"
        )
    return checks.array(raw, "indices", shape=(None, 3), dtype=np.uint32)


def smooth_normals(positions: F32, indices: NDArray[np.uint32]) -> F32:
    """Area-weighted vertex normals (V, 3); vertices of no area get +Y."""
    # In parts, because double-precision corners of a large mesh would take more memory than the
    # mesh.
    sums = np.zeros((3, len(positions)))
    for part in chunks(len(indices)):
        corners = indices[part]
        a, b, c = (positions[corners[:, k]].astype(np.float64) for k in range(3))
        # Unnormalised, so that each face counts by its area.
        face = np.cross(b - a, c - a)
        for axis in range(3):
            np.add.at(sums[axis], corners.ravel(), np.repeat(face[:, axis], 3))
    return cast(F32, unit_or_up(sums.T).astype(np.float32))


def unit_or_up(vectors: NDArray[Any]) -> NDArray[Any]:
    """Rows (n, 3) of length 1; those of length 0, which have no direction, become +Y."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    up = np.array((0.0, 1.0, 0.0), vectors.dtype)
    return np.where(length > 0.0, vectors / np.maximum(length, np.finfo(length.dtype).tiny), up)
