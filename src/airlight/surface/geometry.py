"""All meshes of a scene in shared buffers, drawn material by material."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import SceneError
from ..gpu.device import Gpu
from ..gpu.layout import pack_array
from ..gpu.memory import Buffer, buffer_of
from ..scene.along import meshes_along
from ..scene.checks import F64
from ..scene.material import Material
from ..scene.mesh import Geometry, Mesh, is_mirrored, world_boxes
from ..scene.scene import Scene
from .draws import MAPS, Culling, Draw, draw_order, map_of
from .instances import InstanceData, packed_instances
from .materials import (
    IDENTITY_UV,
    MaterialData,
    differ_in_emission_alone,
    material_fields,
    uv_transform,
)
from .packed_maps import image_of, is_packable
from .textures import MaterialTextures, TextureStore
from .triangle_table import TriangleTable, has_rows
from .vertices import VertexBuffers, Vertices


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
        self.extra_changes = 0
        """Counts geometries whose vertices gained or lost what no row of the table holds."""
        self.replaced = 0
        """Counts how often vertices got other buffers, because other scenes show the old ones."""
        self._texture_sets: dict[tuple[Any, ...], MaterialTextures] = {}
        # Meshes that share geometry and material stand in a row, and are drawn as instances.
        order = draw_order(scene.meshes)
        self.order = [index for run in order for index in run]
        # Each geometry is uploaded once, each material has one row.
        geometries = {id(m.geometry): m.geometry for m in scene.meshes}
        self.original = self.current = scene.meshes
        self._vertices = VertexBuffers(gpu, list(geometries.values()))
        offsets = self._vertices.offsets
        self.first_vertices = [offsets[id(m.geometry)][1] for m in scene.meshes]
        self._take_materials(scene.meshes)
        self.instances = Buffer(
            gpu, "instances", InstanceData.dtype.itemsize * max(1, len(scene.meshes)), vertex=True
        )
        self._packed_instances = b""
        self._first = scene.meshes
        # One draw for each row of instances.
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
                    frozenset(n for n in MAPS if map_of(mesh.material, n) is not None),
                    any(uv_transform(map_of(mesh.material, n)) != IDENTITY_UV for n in MAPS),
                    is_mirrored(mesh),
                )
            )
            first += len(run)
        self._culling = Culling(self.draws)
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
        # Vertices and emission go to buffers of their own, only where they changed.
        deformed = self._deform(meshes)
        deformed = self._relight(meshes) or deformed

        # Rows in the order of draws.
        placed, first = ([of[i] for i in self.order] for of in (meshes, self._first))
        packed = packed_instances(placed, first, self.material_rows)
        self.current = meshes
        # Whoever caches by the version recomputes nothing where nothing has changed.
        if packed.tobytes() == self._packed_instances and not deformed:
            return
        self._packed_instances = packed.tobytes()
        self.instances.write(packed)
        self._culling.place(world_boxes(placed))
        self.version += 1

    def _relight(self, meshes: tuple[Mesh, ...]) -> bool:
        """Upload the emission of materials that changed it; returns whether any did."""
        changed = False
        for mesh, first in zip(meshes, self._first, strict=True):
            row = self._material_index[id(first.material)]
            if mesh.material is self._shown[row]:
                continue
            # Only emission may change: all else is part of pipelines and texture sets.
            if not differ_in_emission_alone(mesh.material, first.material):
                raise SceneError(
                    f"mesh '{mesh.name}' has another material than before",
                    remedy="Make a new Renderer",
                )
            # One row of the materials, and of the table that the visibility buffer reads.
            self._shown[row] = mesh.material
            record = pack_array(MaterialData, [material_fields(mesh.material)])
            self.materials.write(record, row * MaterialData.dtype.itemsize)
            if self._triangle_table:
                self._triangle_table.relight(row, mesh.material)
            changed = True
        return changed

    def _deform(self, meshes: tuple[Mesh, ...]) -> bool:
        """Upload the vertices of geometries that changed; returns whether any did."""
        # The meshes of creation, each with the geometry that it shared.
        if len(meshes) != len(self.first_vertices):
            raise SceneError(
                f"there are {len(meshes)} meshes where there were {len(self.first_vertices)}",
                remedy="Make a new Renderer",
            )

        # Meshes that shared a geometry still must, as they are drawn as its instances.
        wanted: dict[int, Geometry] = {}
        for mesh, first in zip(meshes, self.first_vertices, strict=True):
            if wanted.setdefault(first, mesh.geometry) is not mesh.geometry:
                raise SceneError(
                    f"mesh '{mesh.name}' no longer shares the geometry that it shared",
                    remedy="Make a new Renderer",
                )
        # Geometries are compared by identity: a deformed one is another.
        uploaded = self._vertices.uploaded
        changed = [key for key, geometry in wanted.items() if geometry is not uploaded[key]]

        # Recorded draws and cached lists know by these counts whether they still hold.
        for first in changed:
            geometry, before = wanted[first], uploaded[first]
            self.replaced += self._vertices.deform(first, geometry)
            self.extra_changes += _extras(before) != _extras(geometry)
            if self._triangle_table:
                self.replaced += self._triangle_table.deform(first, geometry)
        return bool(changed)

    def is_drawn_last(self, draw: Draw) -> bool:
        """Whether the visibility buffer of CPU adapters cannot show a draw's material."""
        key = id(draw.material)
        if key not in self._is_packable:
            self._is_packable[key] = is_packable(draw.material)
        geometry = self._vertices.uploaded[draw.base_vertex]
        return not self._is_packable[key] or not has_rows(geometry, draw.material)

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
                self._vertices.uploaded,
                self._materials,
                [
                    (self.first_vertices[i], self._material_index[id(self._first[i].material)])
                    for i in self.order
                ],
                self.store,
            )

            # Materials that changed before the table was made show what they have now.
            for row, (shown, first) in enumerate(zip(self._shown, self._materials, strict=True)):
                if shown is not first:
                    self._triangle_table.relight(row, shown)
        return self._triangle_table

    @property
    def bounds(self) -> tuple[F64, F64]:
        """Lower and upper corner, metres, of all instances; raises ValueError without any."""
        return self._culling.low.min(axis=0), self._culling.high.max(axis=0)

    def bounds_along(self, axes: tuple[tuple[float, float, float], ...]) -> tuple[F64, F64] | None:
        """The same along unit vectors; None without any. Computed once for a placing of meshes."""
        if self._along[0] != (self.version, axes):
            self._along = ((self.version, axes), meshes_along(self.current, np.array(axes)))
        return self._along[1]

    def visible(self, clip_from_world: F64) -> list[Draw]:
        """The draws in view, as `Culling.visible` finds them."""
        return self._culling.visible(clip_from_world).all

    def solid(self, clip_from_world: F64) -> list[Draw]:
        """Those of them that light cannot pass."""
        return self._culling.visible(clip_from_world).solid

    def translucent(self, clip_from_world: F64) -> list[Draw]:
        """Those of them that some light passes."""
        return self._culling.visible(clip_from_world).translucent

    @property
    def has_translucent(self) -> bool:
        """Whether light passes any of the surfaces."""
        return any(draw.material.is_translucent for draw in self.draws)

    @property
    def vertices(self) -> Vertices:
        """The vertices and the indices of all meshes; others once `replaced` counts on."""
        return self._vertices.buffers

    def _textures_of(self, m: Material) -> MaterialTextures:
        """The textures of a material; those with the same maps share one value and bind group."""
        # What a texture shows: its image, whatever its scale, and how it wraps.
        maps = {name: map_of(m, name) for name in MAPS}
        key = tuple(None if t is None else (*image_of(t), t.wrap) for t in maps.values())
        found = self._texture_sets.setdefault(key, MaterialTextures(self.store, maps))
        if m.alpha_cutoff > 0.0:
            found.bound  # noqa: B018  drawn in any case: their mip chains are at hand now
        return found


def _extras(geometry: Geometry) -> tuple[bool, bool]:
    return geometry.colors is not None, geometry.tangents is not None
