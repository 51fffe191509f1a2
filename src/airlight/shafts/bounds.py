"""The nearest and farthest depth of every square of 2^k texels of shadow maps.

The min/max mipmap of Tevs et al. 2008 (maximum mipmaps for rays over height fields) and Chen et
al. 2011; level 0 is the shadow map itself, so only the levels above are stored.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, texture, uniform
from ..surface.shadow import ShadowMaps


class BoundsParams(Struct):
    """Which level is made."""

    side = u32("texels of the map, rounded up to a power of two")
    level = u32()
    layers = u32()
    resolution = u32("texels of the map")


class _Bounds(ComputePass):
    slots = (
        uniform("params", BoundsParams),
        texture("depth", "2d-array", "depth"),
        storage("bounds", "vec2f", "read_write"),
    )
    workgroup = (16, 8, 1)


class DepthBounds:
    """(nearest, farthest) per square, levels 1 up to a single square, one run per layer."""

    def __init__(self, gpu: Gpu, maps: ShadowMaps) -> None:
        self.maps = maps
        self.side = 1 << (max(2, maps.depth.size[0]) - 1).bit_length()
        self.top = self.side.bit_length() - 1
        layers = max(1, maps.layers)
        self.buffer = Buffer(gpu, "shadow bounds", 8 * layers * (self.side * self.side - 1) // 3)
        self._pass = _Bounds(gpu)

    def encode(self, commands: Commands) -> None:
        """Make all levels anew from the maps."""
        if not self.maps.layers:
            return
        for level in range(1, self.top + 1):
            params = BoundsParams(
                side=self.side, level=level, layers=self.maps.layers,
                resolution=self.maps.resolution,
            )  # fmt: skip
            squares = self.side >> level
            self._pass.dispatch(
                commands, (squares, squares, self.maps.layers), params=params,
                depth=self.maps.depth, bounds=self.buffer,
            )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        self.buffer.release()
