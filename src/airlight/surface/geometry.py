"""All meshes of a scene in shared buffers, drawn material by material."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f, pack_array, u32
from ..gpu.memory import Buffer, buffer_of
from ..scene.along import meshes_along
from ..scene.material import Material
from ..scene.material import Texture as SceneTexture
from ..scene.mesh import Geometry, Mesh
from ..scene.scene import Scene
from .materials import (
    IDENTITY_UV,
    MaterialData,
    differ_in_emission_alone,
    material_fields,
    uv_transform,
)
from .packed_maps import image_of, is_packable
from .textures import MaterialTextures, TextureStore
from .triangle_table import TriangleTable

F64 = NDArray[np.float64]
_VERTEX = np.dtype([("normal", np.int16, 4), ("uv", np.float32, 2), ("color", np.float16, 4)])


MOST_CACHED_VIEWS = 256
"""Whose culling is remembered."""

MAPS = ("base_color", "metallic_roughness", "normal", "emission")


class InstanceData(Struct):
    """The transform and the material of one instance of a geometry."""

    world_from_object = mat4x4f()
    normal_from_object = mat4x4f()
    material = u32("index into materials")
    size = f32("m, longest side of its box; negative where it never moved")


@dataclass(frozen=True)
class Draw:
    """Instances of one geometry with one material."""

    first_index: int
    index_count: int
    base_vertex: int
    first_instance: int
    instance_count: int
    material: Material
    textures: MaterialTextures
    maps: frozenset[str]
    has_map_transform: bool  # whether any of the maps has a scale or an offset
    is_mirrored: bool

    def part(self, first: int, count: int) -> Draw:
        """The same draw, of some of its instances."""
        if (first, count) == (self.first_instance, self.instance_count):
            return self
        return replace(self, first_instance=first, instance_count=count)


class GpuScene:
    """Vertex, index, instance and material buffers, and the draws over them.

    Triangles and materials are fixed at creation; `move` updates the instances' transforms and the
    vertices that moved. `current` are the meshes as they are, `version` counts their changes.
    """

    def __init__(self, gpu: Gpu, scene: Scene, store: TextureStore | None = None) -> None:
        """`store`: of another scene that shows the same textures."""
        self.gpu = gpu
        self.store = store or TextureStore(gpu)
        self.version = 0
        self.color_changes = 0
        """Counts geometries whose vertices gained or lost their colours."""
        self._texture_sets: dict[tuple[Any, ...], MaterialTextures] = {}
        order = _draw_order(scene.meshes)
        self.order = [index for run in order for index in run]
        geometries = {id(m.geometry): m.geometry for m in scene.meshes}
        self.original = self.current = scene.meshes
        offsets = self._upload(list(geometries.values()))
        self.first_vertices = [offsets[id(m.geometry)][1] for m in scene.meshes]
        self._uploaded = {offsets[key][1]: g for key, g in geometries.items()}
        self._take_materials(scene.meshes)
        self.instances = Buffer(
            gpu, "instances", InstanceData.dtype.itemsize * max(1, len(scene.meshes)), vertex=True
        )
        self._packed_instances = b""
        self._first = scene.meshes
        self.draws: list[Draw] = []
        first = 0
        for run in order:
            mesh = scene.meshes[run[0]]
            start, base = offsets[id(mesh.geometry)]
            self.draws.append(
                Draw(
                    start,
                    mesh.geometry.indices.size,
                    base,
                    first,
                    len(run),
                    mesh.material,
                    self._textures_of(mesh.material),
                    frozenset(n for n in MAPS if _map(mesh.material, n) is not None),
                    any(uv_transform(_map(mesh.material, n)) != IDENTITY_UV for n in MAPS),
                    is_mirrored(mesh),
                )
            )
            first += len(run)
        counts = [d.instance_count for d in self.draws]
        self._draw_of = np.repeat(np.arange(len(counts)), counts)
        self._visible: dict[bytes, list[Draw]] = {}
        self._along: tuple[Any, tuple[F64, F64] | None] = (None, None)
        self.move(scene.meshes)

    def _take_materials(self, meshes: tuple[Mesh, ...]) -> None:
        materials = {id(m.material): m.material for m in meshes}
        self._material_index = {key: i for i, key in enumerate(materials)}
        self._materials = list(materials.values())
        self._shown = list(self._materials)
        self._is_packable: dict[int, bool] = {}
        self._triangle_table: TriangleTable | None = None
        rows = [material_fields(m) for m in self._materials]
        self.materials = buffer_of(self.gpu, "materials", pack_array(MaterialData, rows))

    def move(self, meshes: tuple[Mesh, ...]) -> None:
        """Update to `meshes`: the meshes of creation, in their order, as they are in this frame.

        Only their transforms, their vertices and their materials' emission may differ. Raises
        SceneError for meshes with other triangles or materials.
        """
        deformed = self._deform(meshes)
        deformed = self._relight(meshes) or deformed
        rows = [
            {
                "world_from_object": m.world_from_object,
                "normal_from_object": _normal_matrix(m.world_from_object),
                "material": self._material_index[id(first.material)],
                "size": _size(m, first),
            }
            for m, first in ((meshes[i], self._first[i]) for i in self.order)
        ]
        packed = pack_array(InstanceData, rows)
        self.current = meshes
        if packed.tobytes() == self._packed_instances and not deformed:
            return
        self._packed_instances = packed.tobytes()
        self.instances.write(packed)
        boxes = np.array([meshes[i].world_bounds for i in self.order]).reshape(-1, 2, 3)
        self._low, self._high = boxes[:, 0], boxes[:, 1]
        self._middles, self._halves = boxes.mean(axis=1), 0.5 * (boxes[:, 1] - boxes[:, 0])
        self._visible.clear()
        self.version += 1

    def _relight(self, meshes: tuple[Mesh, ...]) -> bool:
        """Upload the emission of materials that glow otherwise than before; whether any do."""
        changed = False
        for mesh, first in zip(meshes, self._first, strict=True):
            row = self._material_index[id(first.material)]
            if mesh.material is self._shown[row]:
                continue
            if not differ_in_emission_alone(mesh.material, first.material):
                raise SceneError(
                    f"mesh '{mesh.name}' has another material than before",
                    remedy="Make a new Renderer",
                )
            self._shown[row] = mesh.material
            record = pack_array(MaterialData, [material_fields(mesh.material)])
            self.materials.write(record, row * MaterialData.dtype.itemsize)
            if self._triangle_table:
                self._triangle_table.relight(row, mesh.material)
            changed = True
        return changed

    def _deform(self, meshes: tuple[Mesh, ...]) -> bool:
        """Upload the vertices of geometries that changed; returns whether any did."""
        if len(meshes) != len(self.first_vertices):
            raise SceneError(
                f"there are {len(meshes)} meshes where there were {len(self.first_vertices)}",
                remedy="Make a new Renderer",
            )
        wanted: dict[int, Geometry] = {}
        for mesh, first in zip(meshes, self.first_vertices, strict=True):
            if wanted.setdefault(first, mesh.geometry) is not mesh.geometry:
                raise SceneError(
                    f"mesh '{mesh.name}' no longer shares the geometry that it shared",
                    remedy="Make a new Renderer",
                )
        changed = [key for key, geometry in wanted.items() if geometry is not self._uploaded[key]]
        for first in changed:
            geometry = wanted[first]
            _check_same_triangles(self._uploaded[first], geometry)
            self.positions.write(geometry.positions, 12 * first)
            self.vertices.write(_vertex_data(geometry), _VERTEX.itemsize * first)
            had_colors = self._uploaded[first].colors is not None
            self.color_changes += had_colors != (geometry.colors is not None)
            self._uploaded[first] = geometry
            if self._triangle_table:
                self._triangle_table.deform(first, geometry)
        return bool(changed)

    def is_drawn_last(self, draw: Draw) -> bool:
        """Whether the visibility buffer of CPU adapters cannot show a draw's material."""
        key = id(draw.material)
        if key not in self._is_packable:
            self._is_packable[key] = is_packable(draw.material)
        return not self._is_packable[key] or self._uploaded[draw.base_vertex].colors is not None

    @property
    def material_rows(self) -> list[int]:
        """The row in `materials` of each instance, in the order of `instances`."""
        return [self._material_index[id(self._first[index].material)] for index in self.order]

    @property
    def triangle_table(self) -> TriangleTable:
        """The data that the visibility buffer reads, created when first asked for."""
        if self._triangle_table is None:
            self._triangle_table = TriangleTable(
                self.gpu,
                self._uploaded,
                self._materials,
                [
                    (self.first_vertices[i], self._material_index[id(self._first[i].material)])
                    for i in self.order
                ],
                self.store,
            )
            for row, (shown, first) in enumerate(zip(self._shown, self._materials, strict=True)):
                if shown is not first:
                    self._triangle_table.relight(row, shown)
        return self._triangle_table

    @property
    def bounds(self) -> tuple[F64, F64]:
        """Lower and upper corner, metres, of all instances; raises ValueError without any."""
        return self._low.min(axis=0), self._high.max(axis=0)

    def bounds_along(self, axes: tuple[tuple[float, float, float], ...]) -> tuple[F64, F64] | None:
        """The same along unit vectors; None without any. Computed once for a placing of meshes."""
        if self._along[0] != (self.version, axes):
            self._along = ((self.version, axes), meshes_along(self.current, np.array(axes)))
        return self._along[1]

    def visible(self, clip_from_world: F64) -> list[Draw]:
        """The draws in view: of their instances those that no plane of the clip box excludes.

        The same list is returned for the same view until something moves. The depth planes are not
        tested, because what stands before a light's near plane still casts a shadow.
        """
        key = clip_from_world.tobytes()
        found = self._visible.get(key)
        if found is None:
            if len(self._visible) >= MOST_CACHED_VIEWS:
                self._visible.pop(next(iter(self._visible)))
            found = self._visible[key] = self._culled(clip_from_world)
        return found

    def _culled(self, clip_from_world: F64) -> list[Draw]:
        if not self.draws:
            return []
        x, y, w = clip_from_world[0], clip_from_world[1], clip_from_world[3]
        planes = np.stack([w + x, w - x, w + y, w - y, w])
        # The corner that lies farthest inside a plane decides.
        nearest = self._middles @ planes[:, :3].T + self._halves @ np.abs(planes[:, :3]).T
        is_inside = (nearest + planes[:, 3] >= 0.0).all(axis=1)
        if is_inside.all():
            return self.draws
        # Runs of instances of one draw.
        begins = is_inside & ~(np.roll(is_inside, 1) & (np.roll(self._draw_of, 1) == self._draw_of))
        ends = is_inside & ~(np.roll(is_inside, -1) & (np.roll(self._draw_of, -1) == self._draw_of))
        begins[0], ends[-1] = is_inside[0], is_inside[-1]
        first, last = np.flatnonzero(begins), np.flatnonzero(ends)
        runs = zip(self._draw_of[first].tolist(), first.tolist(), last.tolist(), strict=True)
        return [self.draws[d].part(begin, end - begin + 1) for d, begin, end in runs]

    def _upload(self, geometries: list[Geometry]) -> dict[int, tuple[int, int]]:
        offsets, index_count, vertex_count = {}, 0, 0
        for geometry in geometries:
            offsets[id(geometry)] = (index_count, vertex_count)
            index_count += geometry.indices.size
            vertex_count += len(geometry.positions)
        positions = _joined([g.positions for g in geometries], (0, 3), np.float32)
        indices = _joined([g.indices.ravel() for g in geometries], (0,), np.uint32)
        vertices = _joined([_vertex_data(g) for g in geometries], (0,), _VERTEX)
        self.positions = buffer_of(self.gpu, "positions", positions, vertex=True)
        self.vertices = buffer_of(self.gpu, "vertices", vertices, vertex=True)
        self.indices = buffer_of(self.gpu, "indices", indices, index=True)
        return offsets

    def _textures_of(self, m: Material) -> MaterialTextures:
        """The textures of a material; those with the same maps share one value and bind group."""
        maps = {name: _map(m, name) for name in MAPS}
        key = tuple(None if t is None else (*image_of(t), t.wrap) for t in maps.values())
        found = self._texture_sets.setdefault(key, MaterialTextures(self.store, maps))
        if m.alpha_cutoff > 0.0:
            found.bound  # noqa: B018  drawn in any case: their mip chains are at hand now
        return found


def _check_same_triangles(old: Geometry, new: Geometry) -> None:
    same = len(old.positions) == len(new.positions) and (
        np.shares_memory(old.indices, new.indices) or np.array_equal(old.indices, new.indices)
    )
    if not same:
        raise SceneError(
            f"a geometry of {len(old.positions)} vertices and {len(old.indices)} triangles became "
            f"one of {len(new.positions)} and {len(new.indices)}, or other triangles",
            remedy="Make a new Renderer",
        )


def _map(m: Material, name: str) -> SceneTexture | None:
    texture: SceneTexture | None = getattr(m, f"{name}_texture")
    return texture


def is_mirrored(mesh: Mesh) -> bool:
    """Whether the mesh's transform turns counter-clockwise triangles clockwise."""
    return bool(np.linalg.det(mesh.world_from_object[:3, :3]) < 0.0)


def _draw_order(meshes: tuple[Mesh, ...]) -> list[list[int]]:
    """Mesh indices in runs that share geometry and material, opaque before cut-out."""

    first_use: dict[int, int] = {}
    for mesh in meshes:
        for part in (mesh.material, mesh.geometry):
            first_use.setdefault(id(part), len(first_use))

    def key(index: int) -> tuple[Any, ...]:
        m, g = meshes[index].material, meshes[index].geometry
        maps = tuple(_map(m, name) is not None for name in MAPS)
        sides = (m.two_sided, is_mirrored(meshes[index]))
        return (m.alpha_cutoff > 0.0, sides, maps, first_use[id(m)], first_use[id(g)])

    return [list(run) for _, run in groupby(sorted(range(len(meshes)), key=key), key=key)]


def _vertex_data(g: Geometry) -> NDArray[Any]:
    data = np.zeros(len(g.positions), _VERTEX)
    if g.normals is not None:
        data["normal"][:, :3] = np.round(np.clip(g.normals, -1.0, 1.0) * 32767.0)
    if g.uvs is not None:
        data["uv"] = g.uvs
    data["color"] = 1.0 if g.colors is None else g.colors
    return data


def _normal_matrix(world_from_object: F64) -> F64:
    """The inverse transpose, which keeps normals perpendicular under non-uniform scale."""
    linear = world_from_object[:3, :3]
    normal = np.eye(4)
    # The cofactor matrix is det * inverse transpose and exists for flat transforms too.
    a, b, c = linear.T
    normal[:3, :3] = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    if np.linalg.det(linear) < 0.0:
        normal[:3, :3] *= -1.0
    return normal


def _size(mesh: Mesh, first: Mesh) -> float:
    """`InstanceData.size` of a mesh that stood as `first` does."""
    low, high = mesh.world_bounds
    is_still = mesh.geometry is first.geometry and np.array_equal(
        mesh.world_from_object, first.world_from_object
    )
    size = float(np.max(high - low))
    return -size if is_still else size


def _joined(parts: list[NDArray[Any]], empty: tuple[int, ...], dtype: Any) -> NDArray[Any]:
    if len(parts) == 1:
        return np.ascontiguousarray(parts[0], dtype)
    return np.concatenate(parts) if parts else np.zeros(empty, dtype)
