"""The mean density of grids between a point and every light.

Times the length of the path in the box, which has kinks that a texture would blur, it is the column
density. Texels lie on a lattice that includes the borders of the grid's box; for a point outside
the box that where the path enters counts. Four lights share a texel; groups of four are stacked
along z.

A path is not followed to the end from each texel. Across the axis that a light shines along most,
every so many planes of texels are found first, from the lit side on, each from the one before; a
texel then follows its path to the next of these planes and reads on there. A plane's means are
interpolated as they are wherever columns are read. Columns are found again where the grid, its
place or the lights' places are others than before: the rest keep theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f, pack_array, u32, vec3f, vec3u
from ..gpu.memory import Buffer, Texture, linear_sampler
from ..gpu.slots import image, sampler, storage, texture, uniform
from ..maths.transforms import F64
from ..scene.lights import DirectionalLight, Light
from ..scene.volume import Volume
from ..surface.light_table import packed_lights
from .atlas import LIMIT, DensityAtlas, Region, Size, packed
from .column_texels import Fineness, all_texels
from .media_slots import light_groups

SLABS = 4
"""Slabs of texels that a box is cut into, at most; paths are followed to the end of theirs."""
THINNEST = 2
"""Planes of texels in one of them, at least."""
RUN = 16
"""Texels along z that an invocation finds: a CPU adapter loads what they share lane by lane."""
# At most: the planes that are held at once, workgroups along a side of a dispatch.
_SCRATCH_BYTES = 16 << 20
_MOST_GROUPS = 65535
_PLACED = ("kind", "position", "direction")  # of a light, all that columns depend on


class ColumnGrid(Struct):
    """A density grid and its columns."""

    world_from_box = mat4x4f("its box is 0..1")
    count = vec3u("texels for four lights")
    voxel = f32("m, the shortest side of a cell")
    first = vec3u("texel of the texture")
    grid_first = vec3f("texels, of its densities in the texture of all")
    grid_count = vec3f("texels")


class ColumnPath(Struct):
    """Where a light lies, for one grid."""

    towards = vec3f(
        "of the box, a metre towards the light; where it is local, its place in the box"
    )
    is_local = u32()
    facing = vec3f("1 or -1 on the axis that slabs lie across: on which side the light is")
    thickness = f32("planes of texels in a slab")


class ColumnParams(Struct):
    """Which grids and lights, and which planes."""

    first = u32("in the list of grids")
    grids = u32()
    lights = u32()
    plane = u32("the one that is found, from the lit side on")
    plane_texels = u32("of the largest plane")
    runs = u32("of texels along z, in the deepest slab of four lights")


_SLOTS = (
    uniform("params", ColumnParams),
    storage("grids", ColumnGrid),
    storage("paths", ColumnPath),
    storage("listed", "u32"),
    sampler("column_linear"),
    texture("densities", "3d"),
)
_CONSTANTS = f"const SLABS = {SLABS}u;\nconst RUN = {RUN}u;\n"


class _Planes(ComputePass):
    slots = (*_SLOTS, storage("planes", "f32", "read_write"))
    workgroup = (64, 1, 1)
    file = "column_planes.wgsl"


class _Columns(ComputePass):
    slots = (*_SLOTS, storage("planes", "f32"), image("columns", "rgba16float", "3d"))
    workgroup = (8, 8, 1)
    file = "light_columns.wgsl"


class LightColumns:
    """The mean densities of grids towards each light, in the boxes of one texture.

    `regions`: where the columns of each grid lie; the count is that of the slab of four lights.
    """

    def __init__(
        self,
        gpu: Gpu,
        atlas: DensityAtlas,
        volumes: Sequence[Volume],
        light_count: int,
        fineness: Fineness,
    ) -> None:
        """`volumes`: whose grids the `atlas` holds."""
        self.atlas = atlas
        self._linear = linear_sampler(gpu, "light columns")
        # Some planes across each light's direction come first, then all texels between them.
        self._planes = _Planes(gpu, generated=_CONSTANTS)
        self._columns = _Columns(gpu, generated=_CONSTANTS)
        # Four lights a texel, and a slab of texels for every four.
        groups = light_groups(light_count)
        slabs = all_texels(volumes, fineness, groups, gpu.limits[LIMIT])
        boxes, size = packed([(x, y, z * groups) for x, y, z in slabs], gpu.limits[LIMIT])
        self.regions = [Region(box.first, slab) for box, slab in zip(boxes, slabs, strict=True)]
        self.texture = Texture(
            gpu, "light columns", size, "rgba16float", dimension="3d", written=True
        )
        # Tables, the list of grids to find, and the planes of as many as are found at once.
        most_paths = max(1, light_count) * len(slabs)
        self._paths = Buffer(gpu, "column paths", ColumnPath.dtype.itemsize * most_paths)
        self._grids = Buffer(gpu, "column grids", ColumnGrid.dtype.itemsize * len(slabs))
        self._listed = Buffer(gpu, "columns to find", 4 * len(slabs))
        self._plane_texels = max(_largest_plane(slab) for slab in slabs)
        bytes_each = 4 * (SLABS - 1) * max(1, light_count) * self._plane_texels
        # As many grids at once as fit the scratch buffer and one dispatch.
        deepest = max(slab[2] for slab in slabs) * groups
        most = min(_SCRATCH_BYTES // bytes_each, _MOST_GROUPS // deepest, len(slabs))
        self._at_once = max(1, most)
        self._scratch = Buffer(gpu, "planes of columns", bytes_each * self._at_once)
        # What each grid's columns were found for.
        self._found: list[Any] = [None] * len(slabs)

    def encode(
        self, commands: Commands, lights: tuple[Light, ...], rows: Sequence[dict[str, Any]]
    ) -> None:
        """Find the columns of the grids whose place, densities or lights have changed.

        `rows`: of the grids in the table of media.
        """
        # Columns do not depend on how bright a light is, nor on what a grid is filled with.
        table = packed_lights(lights)
        # A grid is stale once a light, its box or its voxels are others.
        placed = tuple(table[name][: len(lights)].tobytes() for name in _PLACED)
        grids = pack_array(
            ColumnGrid, [self._row(row, at) for row, at in zip(rows, self.regions, strict=True)]
        )
        wanted = [
            (placed, grid.tobytes(), version)
            for grid, version in zip(grids, self.atlas.versions, strict=True)
        ]
        # What was found of equal rows, lights and voxels is right still.
        stale = [i for i, (a, b) in enumerate(zip(wanted, self._found, strict=True)) if a != b]
        if not stale or not lights:
            return
        self._found = wanted
        # Those alone are integrated again, as many at once as a dispatch holds.
        self._paths.write(_paths(rows, [at.count for at in self.regions], table[: len(lights)]))
        self._grids.write(grids)
        self._listed.write(np.array(stale, np.uint32))
        for first in range(0, len(stale), self._at_once):
            self._find(commands, stale, first, len(lights))

    def _row(self, row: dict[str, Any], columns: Region) -> dict[str, Any]:
        from_world: F64 = np.asarray(row["volume_from_world"], np.float64)
        # Columns are followed in the box's own space, 0 to 1 on each axis, and add up metres.
        return {
            "world_from_box": np.linalg.inv(from_world),
            "count": columns.count,
            "voxel": row["voxel"],
            "first": columns.first,
            "grid_first": row["grid_first"],
            "grid_count": row["grid_count"],
        }

    def _find(self, commands: Commands, stale: Sequence[int], first: int, lights: int) -> None:
        """Find the columns of some grids, as many as there is room for the planes of."""
        # As large a dispatch as the largest of these grids needs.
        slabs = [self.regions[i].count for i in stale[first : first + self._at_once]]
        bound = {
            "grids": self._grids,
            "paths": self._paths,
            "listed": self._listed,
            "column_linear": self._linear,
            "densities": self.atlas.texture,
            "planes": self._scratch,
        }
        nx, ny, nz = (max(slab[axis] for slab in slabs) for axis in range(3))
        common = {
            "first": first,
            "grids": len(slabs),
            "lights": lights,
            "plane_texels": self._plane_texels,
            "runs": -(-nz // RUN),
        }
        # The planes one after the other, then all texels between them.
        most = -(-max(map(_largest_plane, slabs)) // RUN)
        for plane in range(max(plane_count(n) for slab in slabs for n in slab)):
            params = ColumnParams.of(plane=plane, **common)
            self._planes.dispatch(commands, (most, lights, len(slabs)), params=params, **bound)
        self._columns.dispatch(
            commands,
            (nx, ny, -(-nz // RUN) * light_groups(lights) * len(slabs)),
            params=ColumnParams.of(plane=0, **common),
            columns=self.texture,
            **bound,
        )

    @property
    def bound(self) -> dict[str, Texture]:
        """By slot name."""
        return {"light_columns": self.texture}


def _paths(
    rows: Sequence[dict[str, Any]], counts: Sequence[Size], lights: NDArray[Any]
) -> NDArray[Any]:
    """A `ColumnPath` for each grid and each row of `lights`, (grids * lights,)."""
    from_world = np.array([row["volume_from_world"] for row in rows], np.float64)
    is_local = lights["kind"] != DirectionalLight.kind
    # Towards the light from anywhere, or from the middle of the box.
    back = np.einsum("gij,lj->gli", from_world[:, :3, :3], -lights["direction"].astype(np.float64))
    places = np.einsum("gij,lj->gli", from_world[:, :3, :3], lights["position"].astype(np.float64))
    places += from_world[:, None, :3, 3]
    towards = np.where(is_local[:, None], places - 0.5, back)
    # Slabs lie across the axis that paths go along most. Beside a local light they go along
    # it in both directions.
    axis = np.abs(towards).argmax(axis=-1)
    most = np.take_along_axis(towards, axis[..., None], axis=-1)[..., 0]
    # A light that lies in the box has slabs on both of its sides, and faces none.
    is_cut = ~is_local | (np.abs(most) > 0.5)
    thickness = np.array([[slab_planes(n) for n in count] for count in counts], np.float64)
    packed = np.zeros(axis.shape, ColumnPath.dtype)
    packed["towards"] = np.where(is_local[:, None], places, back)
    packed["is_local"] = is_local
    packed["facing"] = np.eye(3)[axis] * (np.sign(most) * is_cut)[..., None]
    packed["thickness"] = np.take_along_axis(thickness, axis, axis=1)
    return packed.reshape(-1)


def slab_planes(texels: int) -> int:
    """Planes of texels in each slab that an axis of so many texels is cut into."""
    return max(THINNEST, -(-texels // SLABS))


def plane_count(texels: int) -> int:
    """How many planes are found first: the last of each slab, but for that on the far side."""
    return (texels - 1) // slab_planes(texels)


def _largest_plane(count: tuple[int, int, int]) -> int:
    nx, ny, nz = count
    return max(nx * ny, ny * nz, nz * nx)
