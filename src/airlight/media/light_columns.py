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
from .media_slots import light_groups


class ColumnParams(Struct):
    """The medium whose columns are computed."""

    count = vec3u("texels of one slab")
    medium = u32()
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
    """Per grid a texture of the mean density towards each light."""

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
        self._media = list(grids)
        self._lights: tuple[Light, ...] | None = None
        self._table = Buffer(gpu, "column lights", LightData.dtype.itemsize * max(1, light_count))
        self._pass = _Columns(gpu, slots, generated)
        # Four lights a texel, and a slab of texels for every four.
        self._counts = [_shrunk(shape, resolution) for shape in grids.values()]
        groups = light_groups(light_count)
        self.textures = [
            Texture(
                gpu,
                "light columns",
                (nx, ny, nz * groups),
                "rgba16float",
                dimension="3d",
                written=True,
            )
            for nx, ny, nz in self._counts
        ]

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
        for medium, texture, (nx, ny, nz) in zip(
            self._media, self.textures, self._counts, strict=True
        ):
            params = ColumnParams(count=(nx, ny, nz), medium=medium, light_count=len(lights))
            self._pass.dispatch(
                commands,
                texture.size,
                params=params,
                lights=self._table,
                columns=texture,
                **medium_bound,
            )

    @property
    def bound(self) -> dict[str, Texture]:
        """By slot name."""
        return {f"light_columns{i}": texture for i, texture in enumerate(self.textures)}


def _shrunk(shape: tuple[int, int, int], resolution: int) -> tuple[int, int, int]:
    """At most `resolution` texels on the longest side, at least 2 on each.

    Two per voxel, where that allows: the mean density is not linear within voxels.
    """
    factor = min(2.0, resolution / max(shape))
    nx, ny, nz = (int(n) for n in np.maximum(2, np.ceil(np.array(shape) * factor)))
    return nx, ny, nz
