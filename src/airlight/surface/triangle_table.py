"""The triangles of a scene as the second pass of the visibility buffer reads them.

For each triangle id: corners, normals, texture coordinates, material and its maps. Only CPU
adapters use it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.demands import largest_binding
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import buffer_of
from ..maths.arrays import U32
from ..maths.chunks import chunks
from ..maths.half import HALF_MAX
from ..maths.tangent_angle import packed_normals
from ..scene.material import Material
from ..scene.mesh import Geometry
from .materials import IDENTITY_UV, uv_transform
from .packed_maps import ONE_SIDED, Location, metallic_factor
from .provoking import unique_provoking
from .textures import TextureStore
from .vertices import geometry_digest, joined

WORDS = 20  # of a triangle
_MOST = 65535  # instances, and materials: a pixel has 16 bits for each


def has_rows(geometry: Geometry, material: Material) -> bool:
    """Whether rows of the table hold all that a pixel of that geometry in that material needs.

    Vertex colours are in none, nor are the tangents by which a normal map lies.
    """
    is_plain = geometry.tangents is None or material.normal_texture is None
    return is_plain and geometry.colors is None


def most_triangles(gpu: Gpu) -> int:
    """The most triangles of a scene; the others are rasterised without a visibility buffer."""
    return largest_binding(gpu) // (4 * WORDS)


class InstanceIds(Struct):
    """What a vertex shader adds to its vertex number, and the ids that its pixels store."""

    first = u32("1 + number of its triangle, less its vertex's")
    what = u32("instance | material << 16")


MATERIAL = np.dtype(
    [
        ("base_color", np.float16, 3),
        ("metallic", np.float16),
        ("emission", np.float16, 3),
        ("specular", np.float16),
        ("roughness", np.float16),
        ("normal_scale", np.float16),
        ("flags", np.uint16),
        ("levels", np.uint16),
        ("texels", np.uint32),
        ("size", np.uint32),
    ]
)
"""A material as its pixels need it, in 32 bytes: half floats, as in the G-buffer."""


class _Triangles:
    """Data that tables share: the triangles of `geometries`, by their first vertex in the scene.

    positions  of the vertices of `unique_provoking`
    indices    in the scene's order, into those
    uvs        of the vertices, for holes
    triangles  WORDS u32 each, object space: corner and edges, uv and its edges, normals
    base_vertex, first_index, first_triangle  where those of each geometry begin
    """

    def __init__(self, gpu: Gpu, geometries: Mapping[int, Geometry]) -> None:
        # No two triangles begin at one vertex, so some are copied: where each geometry's are.
        self._sources: dict[int, U32] = {}
        self.base_vertex: dict[int, int] = {}
        self.first_triangle: dict[int, int] = {}
        self.first_index: dict[int, int] = {}
        indices: list[U32] = []
        vertex_count = triangle_count = 0
        for key, geometry in geometries.items():
            self._sources[key], corners = unique_provoking(geometry.indices)
            self.base_vertex[key], self.first_triangle[key] = vertex_count, triangle_count
            self.first_index[key] = 3 * triangle_count
            vertex_count += len(self._sources[key])
            triangle_count += len(corners)
            indices.append(corners.ravel())
        # What the first pass draws: positions and, for holes, texture coordinates.
        parts = list(geometries.values())
        corners = joined(indices, np.uint32)
        moved = [g.positions[self._sources[key]] for key, g in geometries.items()]
        self.positions = buffer_of(gpu, "seen positions", joined(moved, np.float32, 3), vertex=True)
        self.indices = buffer_of(gpu, "seen indices", corners, index=True)
        laid = [_uvs(g)[self._sources[key]] for key, g in geometries.items()]
        self.uvs = buffer_of(gpu, "seen uvs", joined(laid, np.float32, 2), vertex=True)
        # Rows of triangles, for the second pass.
        rows = joined([_triangles(g) for g in parts], np.uint32, WORDS)
        self.triangles = buffer_of(gpu, "triangle table", rows)

    def write(self, base_vertex: int, geometry: Geometry, *, has_other_uvs: bool) -> None:
        """Update the vertices of a geometry that moved."""
        sources, first = self._sources[base_vertex], self.base_vertex[base_vertex]
        self.positions.write(geometry.positions[sources], 12 * first)
        if has_other_uvs:
            self.uvs.write(_uvs(geometry)[sources], 8 * first)
        self.triangles.write(_triangles(geometry), 4 * WORDS * self.first_triangle[base_vertex])


class TriangleTable:
    """Buffers beside those of a `GpuScene`, of the geometries and materials that fit.

    shared     `_Triangles`; scenes on one device share those of the same geometries, until one of
               them moves vertices
    instances  InstanceIds, in the scene's order
    """

    def __init__(
        self,
        gpu: Gpu,
        geometries: dict[int, Geometry],
        materials: list[Material],
        instances: list[tuple[int, int]],
        store: TextureStore,
    ) -> None:
        """`geometries` by their first vertex in the scene's buffers, `instances` their geometry
        (its first vertex) and material in the scene's order."""
        self.gpu = gpu

        # Ids have 16 bits: a scene of more instances or materials is drawn without the table.
        fits = len(instances) <= _MOST and len(materials) <= _MOST
        geometries = _chosen(geometries, most_triangles(gpu) if fits else 0)
        key = ("triangles", *((k, geometry_digest(g)) for k, g in geometries.items()))
        self._lease = gpu.uploads.lease(gpu, key, lambda scope: _Triangles(scope, geometries))
        self.shared = self._lease.value
        self._take_materials(gpu, materials, store)
        self.instances = buffer_of(gpu, "seen instances", self._instances(instances), vertex=True)
        self._last = dict(geometries)

    def shows(self, base_vertex: int, material: Material) -> bool:
        """Whether the table has instances of that geometry with that material."""
        geometry = self._last.get(base_vertex)
        is_plain = geometry is not None and has_rows(geometry, material)
        return is_plain and self._is_packed[id(material)]

    def deform(self, base_vertex: int, geometry: Geometry) -> bool:
        """Update the vertices of a geometry that moved.

        Returns whether that took other buffers, because other scenes show the old vertices.
        """
        if base_vertex not in self.shared.base_vertex:
            return False
        # A buffer that other scenes show is not written to; this scene gets one of its own.
        before = self.shared
        self._lease = self._lease.owned(self.gpu, lambda scope: _Triangles(scope, self._last))
        self.shared = self._lease.value
        has_other_uvs = geometry.uvs is not self._last[base_vertex].uvs
        self.shared.write(base_vertex, geometry, has_other_uvs=has_other_uvs)
        self._last[base_vertex] = geometry
        return self.shared is not before

    def _instances(self, instances: list[tuple[int, int]]) -> NDArray[Any]:
        packed = np.zeros(max(1, len(instances)), InstanceIds.dtype)
        shared = self.shared
        # From vertex numbers to those of triangles, counted from 1: 0 is the background.
        for index, (key, material) in enumerate(instances):
            first = 1 + shared.first_triangle.get(key, 0) - shared.base_vertex.get(key, 0)
            packed[index] = (first & 0xFFFFFFFF, (index & 0xFFFF) | (material & 0xFFFF) << 16)
        return packed

    def relight(self, row: int, material: Material) -> None:
        """Show the emission of a material that changed it."""
        self._rows["emission"][row] = np.minimum(material.emission, HALF_MAX)
        self.materials.write(self._rows[row : row + 1], row * MATERIAL.itemsize)

    def _take_materials(self, gpu: Gpu, materials: list[Material], store: TextureStore) -> None:
        # A material without a location is drawn by the ordinary path.
        locations, self.texels = store.packed(materials)
        self._is_packed = {
            id(m): at is not None for m, at in zip(materials, locations, strict=True)
        }

        # Factors of each material, and where its maps lie.
        rows = np.zeros(max(1, len(materials)), MATERIAL)
        uv_transforms = np.tile(np.array(IDENTITY_UV, np.float32), (len(rows), 1))
        for index, (m, location) in enumerate(zip(materials, locations, strict=True)):
            rows[index] = _fields(m, location)
            # Packable maps share one transform, so any of them tells it.
            some = m.base_color_texture or m.normal_texture or m.metallic_roughness_texture
            uv_transforms[index] = uv_transform(some)
        self.materials = buffer_of(gpu, "seen materials", rows)
        self._rows = rows
        self.uv_transforms = buffer_of(gpu, "uv_transforms of maps", uv_transforms)
        self.has_map_transforms = bool((uv_transforms != IDENTITY_UV).any())


def _chosen(geometries: dict[int, Geometry], most: int) -> dict[int, Geometry]:
    """The first geometries that have no more than `most` triangles together."""
    kept, count = {}, 0
    for key, geometry in geometries.items():
        if count + len(geometry.indices) <= most:
            kept[key] = geometry
            count += len(geometry.indices)
    return kept


def _fields(m: Material, location: Location | None) -> tuple[Any, ...]:
    """The values of `MATERIAL`."""
    # Packed maps, and the factors that half floats hold.
    texels, size, flags, levels = location or (0, 1 | 1 << 16, 0, 1)
    metallic = m.metallic * (metallic_factor(m) or 0.0)
    emission = np.minimum(m.emission, HALF_MAX)
    return (
        m.base_color,
        metallic,
        emission,
        m.specular,
        m.roughness,
        m.normal_scale,
        flags | (0 if m.two_sided else ONE_SIDED),
        levels,
        texels,
        size,
    )


def _uvs(g: Geometry) -> NDArray[np.float32]:
    return np.zeros((len(g.positions), 2), np.float32) if g.uvs is None else g.uvs


def _triangles(g: Geometry) -> U32:
    """(T, WORDS): corner and two edges, texture coordinates likewise, three normals."""
    rows = np.zeros((len(g.indices), WORDS), np.uint32)
    floats, halves = rows.view(np.float32), rows.view(np.int16)
    p, uv = g.positions, _uvs(g)
    normals = None
    if g.normals is not None:
        # Rounded as the scene's vertices are.
        normals = packed_normals(g.normals)

    # Corner and edges, so that a pixel's barycentric coordinates need no subtraction.
    for part in chunks(len(rows)):
        a, b, c = (g.indices[part, k] for k in range(3))
        values = (p[a], p[b] - p[a], p[c] - p[a], uv[a], uv[b] - uv[a], uv[c] - uv[a])
        np.concatenate(values, axis=1, out=floats[part, :15])
        if normals is not None:
            halves[part, 30:39] = normals[g.indices[part]].reshape(-1, 9)
    return rows
