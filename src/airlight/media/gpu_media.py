"""All participating media of a scene on the device, overlapping freely.

A pass reads them with `//! use media`, the slots `GpuMedia.slots`, the generated text
`GpuMedia.wgsl` and the resources `GpuMedia.bound`. Extinctions add up; each medium keeps its own
albedo and phase function. Density grids lie in one texture (`atlas`), their columns towards lights
in another, and what a ray or a point does not meet is skipped by a tree of boxes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.layout import pack_array
from ..gpu.memory import linear_sampler
from ..gpu.rows import Table
from ..gpu.shared import Shared
from ..gpu.slots import Slot
from ..maths.transforms import F64
from ..scene.fingerprint import is_same
from ..scene.lights import Light
from ..scene.medium import Medium, medium_box
from ..scene.scene import Scene
from ..scene.volume import Volume
from .density_grids import ColumnPlan, density_atlas, light_columns
from .detail import detail_texture
from .emission_grids import NO_GRID, EmissionGrids, glows, has_emission
from .media_changes import MediaChanges
from .media_rows import (
    BOX,
    GRID,
    NO_SHAFTS,
    SHAFTS_OF_ALL,
    SHAFTS_OF_LOCAL,
    detail_fields,
    gridded,
    has_detail,
    kind_of,
    medium_fields,
    row_kinds,
    unit_from_box,
    voxel_m,
)
from .media_slots import (
    MediumData,
    column_slots,
    column_wgsl,
    emission_slots,
    emission_wgsl,
    has_tree,
    medium_slots,
    medium_wgsl,
    path_list_reads,
    path_list_slots,
    path_list_wgsl,
    room_for,
)
from .media_tree import media_nodes
from .path_lists import path_lists

_OWN_COLUMNS = ColumnPlan()
MAX_MEDIA = 256
"""A ray's list of media and their intervals are private to a shader, which WebGPU gives 8 KiB."""


class GpuMedia:
    """All media of a scene. Their number, kinds and grids' sizes are fixed; the rest may change.

    `version` is raised whenever anything did. Raises SceneError for more media or grids than the
    device is given.
    """

    def __init__(
        self,
        gpu: Gpu,
        scene: Scene,
        *,
        light_count: int,
        columns: ColumnPlan = _OWN_COLUMNS,
        solved: Sequence[Medium | Volume] = (),
        has_local_shafts: bool = False,
    ) -> None:
        """`light_count`: lights with columns through grids, 0 or all of them; `columns`: which.

        `solved` media have single scattering in their source, with `has_local_shafts` not of local
        lights.
        """
        self.gpu = gpu
        # By index: a frame may bring its volumes with other coefficients.
        self._solved_shafts = SHAFTS_OF_LOCAL if has_local_shafts else NO_SHAFTS
        self._is_own_solved = any(scene.medium is s for s in solved)
        self._solved = {i for i, v in enumerate(scene.volumes) if any(v is s for s in solved)}
        self._kinds = row_kinds(scene)
        self.count, grids = len(self._kinds), self._kinds.count(GRID)
        if self.count > MAX_MEDIA:
            raise SceneError(
                f"the scene has {self.count} media, at most {MAX_MEDIA} can be drawn at once",
                remedy="Merge some of the volumes into one grid",
            )
        # Media as rows of a table, their densities as boxes of a texture.
        self.table = Table(gpu, "media", MediumData, room_for(self.count))
        volumes, shared = gridded(scene), columns.shared or Shared()
        self.atlas = density_atlas(gpu, volumes, shared) if volumes else None
        self._densities_seen = -1
        self._linear = linear_sampler(gpu, "media")
        self.rows: list[dict[str, Any]] = []
        self._written = b""
        # What the table was filled from: frozen media, and the box of those without bounds.
        self._taken: tuple[object, ...] = ()
        self.version, self._changes = 0, MediaChanges()
        self.has_emission, has_glow = has_emission(scene), any(map(glows, scene.volumes))
        self._emission = EmissionGrids(gpu, scene.volumes) if has_glow else None
        # What passes bind, and the WGSL that reads it: media alone, or with columns towards lights.
        is_detailed = has_detail(scene)
        self._noise = detail_texture(gpu) if is_detailed else None
        self._repeat = linear_sampler(gpu, "media detail", wrap="repeat")
        self.medium_slots = medium_slots(grids, has_detail=is_detailed)
        self.medium_slots += emission_slots(has_grids=has_glow)
        self.medium_wgsl = medium_wgsl(self.count, grids, has_detail=is_detailed)
        self.medium_wgsl += emission_wgsl(has_emission=self.has_emission, has_grids=has_glow)
        # A pass that needs no columns binds none, whatever lights the scene has.
        read = grids if light_count else 0
        self.columns = light_columns(gpu, volumes, light_count, columns, shared) if read else None
        self.paths = path_lists(gpu, scene.bounds, self._kinds, light_count, columns, shared)
        self.slots, self.wgsl = self._towards_lights(scene, read, light_count)
        self._lights: tuple[Light, ...] | None = None  # that columns were last asked for

    @property
    def has_grids(self) -> bool:
        """Whether any medium is heterogeneous."""
        return self.atlas is not None

    @property
    def has_shafts(self) -> bool:
        """Whether shafts draw single scattering of any medium."""
        solved = len(self._solved) + int(self._is_own_solved)
        return self.count > solved or self._solved_shafts != NO_SHAFTS

    @property
    def is_one_box(self) -> bool:
        """Whether the only medium is one homogeneous box."""
        return self._kinds == (BOX,)

    @property
    def finest_voxel_m(self) -> float:
        """The shortest cell side of all grids, metres; infinite without grids."""
        return min((r["voxel"] for r in self.rows if r["kind"] == GRID), default=float("inf"))

    def update(self, commands: Commands, scene: Scene, low: F64, high: F64) -> None:
        """Bring media and the depth towards lights up to date.

        low..high, metres: what a medium without bounds fills, with the camera. Raises SceneError
        where the media are of other kinds than at creation.
        """
        changed = self._take_media(scene, low, high)
        self.version += int(changed)
        # Columns and lists of paths depend on media and lights alone.
        if not (changed or scene.lights != self._lights):
            return
        self._lights = scene.lights
        # Lists of media on paths, then columns: both depend on where lights and media are.
        if self.paths is not None:
            with commands.stage("path lists"):
                self.paths.encode(commands, self.table, scene.lights, self.rows)
        if self.columns is not None:
            rows = [row for row in self.rows if row["kind"] == GRID]
            self.columns.encode(commands, scene.lights, rows)

    def _take_media(self, scene: Scene, low: F64, high: F64) -> bool:
        """Bring the table and the grids up to date; returns whether anything changed."""
        # Media are frozen: the same ones, in the same bounds and for the same eye, need nothing.
        box = (*map(float, low), *map(float, high), *scene.camera.position)
        taken = (box, scene.medium, *scene.volumes)
        if is_same(taken, self._taken):
            return False
        # Kernels are made for these kinds of media.
        if row_kinds(scene) != self._kinds or has_emission(scene) > self.has_emission:
            raise SceneError("the scene's media changed in kind", remedy="Make a new Renderer")
        # Rows are few and quickly made; they and the grids are uploaded where they differ.
        changed = False
        if self.atlas is not None:
            self.atlas.update([v.density for v in scene.volumes if v.density is not None])
            changed = self.atlas.version != self._densities_seen
            self._densities_seen = self.atlas.version
        self.rows = self._rows(scene, low, high)
        packed = np.zeros(room_for(self.count), MediumData.dtype)
        packed[: max(1, self.count)] = pack_array(MediumData, self.rows)
        # Changes are told by rows without the tree, whose nodes move with any medium.
        plain, boxes = packed.tobytes(), np.array(packed["volume_from_world"])
        blocks = self.paths.count if self.paths else None
        packed["nodes"] = media_nodes(self.rows, len(packed), blocks)
        if self._emission is not None:
            changed = self._emission.update(scene.volumes) or changed
        if packed.tobytes() != self._written:
            self._written, changed = packed.tobytes(), True
            self.table.write(packed)
        self._taken = taken
        # Readers that lag behind ask which boxes changed since their version.
        if changed:
            self._changes.take(self.version + 1, plain, boxes, self._grid_versions())
        return changed

    def _grid_versions(self) -> list[int]:
        """The version of each medium's densities."""
        grids = iter(self.atlas.versions if self.atlas else ())
        return [next(grids) if row["kind"] == GRID else 0 for row in self.rows]

    def touched_since(self, version: int) -> NDArray[np.float32] | None:
        """The boxes (n, 4, 4) of media before and after they changed since a `version`.

        None: anywhere; also where a tree was built again, and media add up in another order.
        """
        if has_tree(self.count) and self.paths is None and version != self.version:
            return None
        return self._changes.since(version, self.version)

    @property
    def medium_bound(self) -> dict[str, Any]:
        """The resources of `wgsl/media.wgsl` alone."""
        bound: dict[str, Any] = {"media": self.table}
        # What the scene lacks has no slot either: grids, glowing grids, noise.
        if self.atlas is not None:
            bound |= {"media_linear": self._linear, "media_densities": self.atlas.texture}
        if self._emission is not None:
            bound["emission_grids"] = self._emission.texture
        if self._noise is not None:
            bound |= {"media_repeat": self._repeat, "medium_noise_texture": self._noise}
        return bound

    @property
    def bound(self) -> dict[str, Any]:
        """By slot name, for passes made with `slots`."""
        bound = self.medium_bound | (self.columns.bound if self.columns else {})
        return bound | (self.paths.bound if self.paths else {})

    def _towards_lights(
        self, scene: Scene, grids: int, light_count: int
    ) -> tuple[tuple[Slot, ...], str]:
        """The slots of passes that read columns and lists of paths as well, and their WGSL."""
        slots = self.medium_slots + column_slots(grids)
        has_sized = any(light.has_size for light in scene.lights)
        wgsl = self.medium_wgsl
        wgsl += column_wgsl(grids, light_count, has_sized_lights=has_sized)
        wgsl += path_list_wgsl(self.count, has_lists=self.paths is not None)
        wgsl += path_list_reads(has_lists=self.paths is not None)
        return slots + (path_list_slots() if self.paths else ()), wgsl

    def _rows(self, scene: Scene, low: F64, high: F64) -> list[dict[str, Any]]:
        # The scene's own medium comes first, then its volumes in their order.
        rows = []
        if scene.medium is not None:
            box = medium_box(scene.medium, low, high, scene.camera.position)
            shafts = self._solved_shafts if self._is_own_solved else SHAFTS_OF_ALL
            rows.append(medium_fields(scene.medium, BOX, unit_from_box(*box), shafts=shafts))
        grids = iter(self.atlas.regions if self.atlas is not None else ())
        columns = iter(self.columns.regions if self.columns is not None else ())
        # Its box in the world, its coefficients and where its grids lie.
        for index, volume in enumerate(scene.volumes):
            kind = kind_of(volume)
            to_world = np.asarray(volume.world_from_volume)
            matrix = unit_from_box(*np.asarray(volume.bounds)) @ np.linalg.inv(to_world)
            shafts = self._solved_shafts if index in self._solved else SHAFTS_OF_ALL
            row = medium_fields(volume, kind, matrix, shafts=shafts)
            place = self._emission.places[index] if self._emission else NO_GRID
            row |= {"emission_first": place.first, "emission_count": place.count}
            # Its texels in the texture of all grids, and those of its columns.
            if kind == GRID:
                region = next(grids)
                row |= {
                    "grid_first": region.first,
                    "grid_count": region.count,
                    "voxel": voxel_m(volume),
                }
                if self.columns is not None:
                    place_of = next(columns)
                    row |= {
                        "columns_first": place_of.first,
                        "columns_count": place_of.count,
                    }
                if self._noise is not None and volume.detail > 0.0:
                    row |= detail_fields(volume)
            rows.append(row)
        # Media of the same mean cosine have the same number.
        phases = {g: i for i, g in enumerate(dict.fromkeys(tuple(row["g"]) for row in rows))}
        return [row | {"phase": phases[tuple(row["g"])]} for row in rows]
