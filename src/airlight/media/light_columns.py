"""The mean density of grids between a point and every light.

Times the length of the path in the box, which has kinks that a texture would blur, it is the column
density. Texels lie on a lattice that includes the borders of the grid's box; for a point outside
the box that where the path enters counts. Four lights share a texel; groups of four are stacked
along z.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, pack_array, u32, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import Slot, image, storage, uniform
from ..scene.lights import Light
from ..surface.light_table import LightData, light_rows
from .atlas import LIMIT, Region, packed
from .media_slots import light_groups


class ColumnParams(Struct):
    """The medium whose columns are computed."""

    count = vec3u("texels of one slab")
    medium = u32()
    first = vec3u("texel of the texture")
    light_count = u32()


class _Columns(ComputePass):
    workgroup = (8, 8, 4)
    file = "light_columns.wgsl"

    def __init__(self, gpu: Gpu, slots: tuple[Slot, ...], generated: str) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", ColumnParams),
            storage("lights", LightData),
            *slots,
            image("columns", "rgba16float", "3d"),
        )
        super().__init__(gpu, generated=generated)


class LightColumns:
    """The mean densities of grids towards each light, in the boxes of one texture.

    `regions`: where the columns of a grid lie, by its row in the table of media; the count is that
    of the slab of four lights.
    """

    def __init__(
        self,
        gpu: Gpu,
        slots: tuple[Slot, ...],
        generated: str,
        grids: Mapping[int, tuple[int, int, int]],
        light_count: int,
        resolution: int,
    ) -> None:
        """`grids`: by their rows in the table of media, their counts (x, y, z)."""
        self._lights: tuple[Light, ...] | None = None
        self._table = Buffer(gpu, "column lights", LightData.dtype.itemsize * max(1, light_count))
        self._pass = _Columns(gpu, slots, generated)
        # Four lights a texel, and a slab of texels for every four.
        self._groups = light_groups(light_count)
        slabs = [_shrunk(shape, resolution) for shape in grids.values()]
        boxes, size = packed([(x, y, z * self._groups) for x, y, z in slabs], gpu.limits[LIMIT])
        self.regions = {
            row: Region(box.first, slab) for row, box, slab in zip(grids, boxes, slabs, strict=True)
        }
        self.texture = Texture(
            gpu, "light columns", size, "rgba16float", dimension="3d", written=True
        )

    def encode(
        self,
        commands: Commands,
        lights: tuple[Light, ...],
        medium_bound: dict[str, Any],
        *,
        changed: bool,
    ) -> None:
        """Compute the columns where the media (`changed`) or the lights changed."""
        if lights == self._lights and not changed:
            return
        self._lights = lights
        self._table.write(pack_array(LightData, light_rows(lights)))
        # Optical depths from every voxel of a grid towards every light.
        for medium, region in self.regions.items():
            (nx, ny, nz), count = region.count, len(lights)
            params = ColumnParams(
                count=region.count, medium=medium, first=region.first, light_count=count
            )
            self._pass.dispatch(
                commands,
                (nx, ny, nz * self._groups),
                params=params,
                lights=self._table,
                columns=self.texture,
                **medium_bound,
            )

    @property
    def bound(self) -> dict[str, Texture]:
        """By slot name."""
        return {"light_columns": self.texture}


def _shrunk(shape: tuple[int, int, int], resolution: int) -> tuple[int, int, int]:
    """At most `resolution` texels on the longest side, at least 2 on each.

    Two per voxel, where that allows: the mean density is not linear within voxels.
    """
    factor = min(2.0, resolution / max(shape))
    nx, ny, nz = (int(n) for n in np.maximum(2, np.ceil(np.array(shape) * factor)))
    return nx, ny, nz
