"""Orphan points: gather points of pixels that no point of a block is like.

A block of pixels has one gather point, on one of its surfaces. What else it shows, a window's bar,
a fold of a curtain, a leaf, has points of its own: as many as rows of texels below those of the
blocks hold.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import image, storage, texture, uniform
from .point_params import PointParams

SHARE = 4
"""Blocks for each orphan point that an image has at most."""
_BLOCK_BITS = 15  # of a word that says which pixel of which block an orphan is


class _Find(ComputePass):
    slots = (
        uniform("params", PointParams),
        texture("depth", "2d", "depth"),
        texture("normal", "2d", "unfilterable-float"),
        texture("places", "2d", "unfilterable-float"),
        texture("planes", "2d", "unfilterable-float"),
        storage("choices", "vec4u", "read_write"),
    )
    workgroup = (8, 8, 1)
    in_bands = True
    file = "orphans.wgsl"


class _List(ComputePass):
    slots = (
        uniform("params", PointParams),
        storage("choices", "vec4u"),
        storage("orphans", "u32", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "orphan_list.wgsl"


class _Points(ComputePass):
    slots = (
        uniform("params", PointParams),
        texture("depth", "2d", "depth"),
        texture("normal", "2d", "unfilterable-float"),
        texture("near_field", "2d", "uint"),
        storage("orphans", "u32"),
        image("places", "rgba32float"),
        image("normals", "rgba16float"),
        image("planes", "rgba16float"),
    )
    workgroup = (8, 8, 1)
    file = "orphan_points.wgsl"


class Orphans:
    """The orphan points of an image of so many `blocks`.

    `buffer` holds, of each block, where in the list its orphans begin and how many there are; then
    of each in the list its block and which pixel of that it is.
    """

    def __init__(self, gpu: Gpu, blocks: tuple[int, int], scale: int, *, is_occluded: bool) -> None:
        """`scale`: pixels along a side of a block. Where each pixel is one, none is an orphan."""
        width, height = blocks
        assert width * height <= 1 << _BLOCK_BITS
        self.rows = -(-height // SHARE) if scale > 1 else 0
        self.most = self.rows * width
        self.buffer = Buffer(gpu, "orphan pixels", 4 * (width * height + self.most))
        self._blocks = blocks
        if self.rows:
            constants = {"HAS_OCCLUSION": float(is_occluded)}
            self._choices = Buffer(gpu, "orphans of blocks", 16 * width * height)
            self._find, self._list = _Find(gpu), _List(gpu)
            self._points = _Points(gpu, constants=constants)

    def encode(self, commands: Commands, params: PointParams, bound: dict[str, Any]) -> None:
        """Find them. `bound`: the G-buffer, its occlusion, and the textures of points by name."""
        if not self.rows:
            return
        read = {name: bound[name] for name in ("depth", "normal", "places", "planes")}
        self._find.dispatch(commands, self._blocks, params=params, **read, choices=self._choices)
        self._list.dispatch(
            commands, (256,), params=params, choices=self._choices, orphans=self.buffer
        )
        size = (self._blocks[0], self.rows)
        self._points.dispatch(commands, size, params=params, **bound, orphans=self.buffer)
