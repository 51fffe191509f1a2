"""Which media may lie between a point and a light: lists, by light, for blocks of space.

Cells, texels and rays ask for the light of many lights through many media. To walk a tree of boxes
for each of them costs far more than the few media that are met, so the walk is made once for a
block of space: a bit for each medium whose box may be met from anywhere in the block. Blocks fill
the box of all media; light from beyond it is looked up where it enters the box. Lists are made
again where a box or a light is elsewhere; `wgsl/path_lists.wgsl` reads them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec3f, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.rows import Table, table
from ..gpu.shared import Shared
from ..gpu.slots import image, storage, uniform
from ..maths.transforms import F64
from ..scene.lights import DirectionalLight, Light
from ..surface.light_table import packed_lights
from .atlas import LIMIT, Size
from .density_grids import ColumnPlan
from .media_slots import MediumData, has_tree, list_texels, path_list_wgsl, tree_wgsl

BLOCKS = 1024
"""In all, about; more make shorter lists, which take longer to make."""
_MOST_ALONG = 32  # the root of the media's tree has six bits for each (media_tree)
RUN = 8
"""Lists that an invocation makes: a CPU adapter loads the media that they share lane by lane."""
_PLACED = ("kind", "position", "direction")  # of a light, all that lists depend on


class PathListParams(Struct):
    """Numbers of media, lights and blocks."""

    media = u32()
    lights = u32()
    blocks = vec3u("along x, y, z")


class PathLight(Struct):
    """Where a light lies."""

    towards = vec3f("a direction towards it, or its place, m")
    is_local = u32()


class _PathLists(ComputePass):
    workgroup = (64, 1, 1)
    slots = (
        uniform("params", PathListParams),
        table("media", MediumData),
        storage("path_lights", PathLight),
        image("lists", "rgba32uint", "3d"),
    )


class PathLists:
    """For each block and each light, the media that light from there may meet.

    `count`: blocks along x, y, z.
    """

    def __init__(
        self, gpu: Gpu, bounds: tuple[F64, F64], media_count: int, light_count: int
    ) -> None:
        """`bounds`: about where media lie, metres; blocks are cubes if they fill them."""
        self.count = _blocks(np.subtract(bounds[1], bounds[0]))
        # A texel has bits for 128 media; the lists of lights lie behind one another along z.
        nx, ny, nz = self.count
        size = (nx * ny, nz, light_count * list_texels(media_count))
        self.texture = Texture(gpu, "path lists", size, "rgba32uint", dimension="3d", written=True)
        generated = tree_wgsl(media_count) + path_list_wgsl(media_count, has_lists=True)
        generated += f"const LISTS_AT_ONCE = {RUN}u;\n"
        self._pass = _PathLists(gpu, generated=generated)
        self._lights = Buffer(gpu, "lights of path lists", PathLight.dtype.itemsize * light_count)
        self._made: tuple[bytes, ...] = ()

    def encode(
        self,
        commands: Commands,
        table: Table,
        lights: tuple[Light, ...],
        rows: Sequence[dict[str, Any]],
    ) -> None:
        """Make the lists again, if lights or the boxes of media, `rows` of `table`, are others."""
        # Lists depend on where lights and boxes are, not on how strong or how dense.
        packed = packed_lights(lights)[: len(lights)]
        boxes = np.array([row["volume_from_world"] for row in rows], np.float32)
        made = (boxes.tobytes(), *(packed[name].tobytes() for name in _PLACED))
        if made == self._made or not lights:
            return
        self._made = made
        # One invocation makes a run of neighbouring lists, which share most of their media.
        self._lights.write(_path_lights(packed))
        nx, ny, nz = self.count
        self._pass.dispatch(
            commands,
            (-(-nx * ny * nz // RUN), len(lights)),
            params=PathListParams(media=len(rows), lights=len(lights), blocks=self.count),
            media=table,
            path_lights=self._lights,
            lists=self.texture,
        )

    @property
    def bound(self) -> dict[str, Texture]:
        """By slot name."""
        return {"path_lists": self.texture}


def path_lists(
    gpu: Gpu,
    bounds: tuple[F64, F64],
    kinds: tuple[int, ...],
    light_count: int,
    columns: ColumnPlan,
    shared: Shared,
) -> PathLists | None:
    """Lists for so many lights, once for all tables of the same media; None for few media.

    `kinds` of the media, as `media_rows` has them; `columns` say whose lights they are.
    """
    # A texture has room for the lists of so many lights.
    has_room = light_count * list_texels(len(kinds)) <= gpu.limits[LIMIT]
    if not light_count or not has_tree(len(kinds)) or not has_room:
        return None
    key = ("path lists", kinds, light_count, columns.towards)
    return shared.once(key, lambda: PathLists(gpu, bounds, len(kinds), light_count))


def _blocks(extent: F64) -> Size:
    """How many blocks there are along each side."""
    # A flat side counts as a thousandth of the longest.
    extent = np.maximum(extent, 1e-3 * max(float(np.max(extent)), 1e-6))
    side = np.cbrt(np.prod(extent) / BLOCKS)
    nx, ny, nz = (int(n) for n in np.clip(np.ceil(extent / side), 1, _MOST_ALONG))
    return nx, ny, nz


def _path_lights(packed: NDArray[Any]) -> NDArray[Any]:
    # A direction towards a distant light, the position of a local one.
    is_local = packed["kind"] != DirectionalLight.kind
    found = np.zeros(len(packed), PathLight.dtype)
    found["towards"] = np.where(is_local[:, None], packed["position"], -packed["direction"])
    found["is_local"] = is_local
    return found
