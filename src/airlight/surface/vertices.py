"""Vertices of all geometries of a scene in shared buffers.

positions    float32 x 3, apart, because shadow maps read nothing else
vertices     normal with its tangent's angle, texture coordinates, colour
indices      of each geometry from 0, drawn with a base vertex
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..gpu.device import Gpu
from ..gpu.memory import Buffer, buffer_of
from ..maths.tangent_angle import packed_normals, packed_tangents
from ..scene.fingerprint import array_digest
from ..scene.mesh import Geometry

_VERTEX = np.dtype([("normal", np.int16, 4), ("uv", np.float32, 2), ("color", np.float16, 4)])


def geometry_digest(g: Geometry) -> bytes:
    """Equal for geometries of the same vertices and triangles; cached on the (immutable) one."""
    known: bytes | None = g.__dict__.get("_digest")
    if known is None:
        known = array_digest(g.positions, g.indices, g.normals, g.uvs, g.colors, g.tangents)
        object.__setattr__(g, "_digest", known)
    return known


class Vertices:
    """Of `geometries`, one after the other, in a buffer each: positions, vertices and indices."""

    def __init__(self, gpu: Gpu, geometries: Sequence[Geometry]) -> None:
        positions = joined([g.positions for g in geometries], np.float32, 3)
        indices = joined([g.indices.ravel() for g in geometries], np.uint32)
        vertices = joined([_vertex_data(g) for g in geometries], _VERTEX)
        self.positions: Buffer = buffer_of(gpu, "positions", positions, vertex=True)
        self.vertices: Buffer = buffer_of(gpu, "vertices", vertices, vertex=True)
        self.indices: Buffer = buffer_of(gpu, "indices", indices, index=True)


class VertexBuffers:
    """The buffers, and `offsets`: by a geometry's id, its first index and its first vertex.

    Scenes on one device share buffers of the same geometries, until one of them moves vertices.
    """

    def __init__(self, gpu: Gpu, geometries: list[Geometry]) -> None:
        self.gpu = gpu
        self.offsets: dict[int, tuple[int, int]] = {}

        # Where each geometry begins among indices and among vertices.
        index_count = vertex_count = 0
        for geometry in geometries:
            self.offsets[id(geometry)] = (index_count, vertex_count)
            index_count += geometry.indices.size
            vertex_count += len(geometry.positions)
        # All geometries in one buffer each, so that a draw names offsets only.
        key = ("vertices", *map(geometry_digest, geometries))
        self._lease = gpu.uploads.lease(gpu, key, lambda scope: Vertices(scope, geometries))
        self.buffers = self._lease.value
        self.uploaded = {self.offsets[id(g)][1]: g for g in geometries}
        """By first vertex, the geometry as it was uploaded last."""

    def deform(self, first: int, geometry: Geometry) -> bool:
        """Upload the vertices of the geometry from vertex `first` on.

        Returns whether that took other buffers, because other scenes show the old vertices.
        Raises SceneError where it has other triangles than before.
        """
        check_same_triangles(self.uploaded[first], geometry)
        # A buffer that other scenes show is not written to; this scene gets one of its own.
        before = self.buffers
        self._lease = self._lease.owned(
            self.gpu, lambda scope: Vertices(scope, list(self.uploaded.values()))
        )
        self.buffers = self._lease.value
        self.buffers.positions.write(geometry.positions, 12 * first)
        self.buffers.vertices.write(_vertex_data(geometry), _VERTEX.itemsize * first)
        self.uploaded[first] = geometry
        return self.buffers is not before


def check_same_triangles(old: Geometry, new: Geometry) -> None:
    """Raise SceneError where a geometry became one of other triangles."""
    # Shared indices are equal without a look at them.
    same = len(old.positions) == len(new.positions) and (
        np.shares_memory(old.indices, new.indices) or np.array_equal(old.indices, new.indices)
    )
    if not same:
        raise SceneError(
            f"a geometry of {len(old.positions)} vertices and {len(old.indices)} triangles became "
            f"one of {len(new.positions)} and {len(new.indices)}, or other triangles",
            remedy="Make a new Renderer",
        )


def _vertex_data(g: Geometry) -> NDArray[Any]:
    # Normals as 16-bit integers, colours as half floats; no colour is white.
    data = np.zeros(len(g.positions), _VERTEX)
    if g.normals is not None:
        data["normal"][:, :3] = packed_normals(g.normals)
    if g.tangents is not None:
        data["normal"][:, 3] = packed_tangents(data["normal"][:, :3], g.tangents)
    if g.uvs is not None:
        data["uv"] = g.uvs
    data["color"] = 1.0 if g.colors is None else g.colors
    return data


def joined(parts: list[NDArray[Any]], dtype: Any, *row: int) -> NDArray[Any]:
    """The parts' rows one after the other; of a single part there is no copy."""
    if len(parts) == 1:
        return np.ascontiguousarray(parts[0], dtype)
    return np.concatenate(parts) if parts else np.zeros((0, *row), dtype)
