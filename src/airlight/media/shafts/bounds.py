"""The nearest and farthest depth of every square of 2^k texels of shadow maps.

The min/max mipmap of Tevs2008 (maximum mipmaps for rays over height fields) and Chen2011; level 0
is the shadow map itself, so only the levels above are stored.
"""

from __future__ import annotations

from functools import partial

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32
from ...gpu.memory import Buffer
from ...gpu.recorded import Recorded
from ...gpu.slots import storage, uniform
from ...lighting.lights import TEXEL_BYTES
from ...surface.shadow import ShadowMaps

_ROW_TEXELS = 64
"""Of 4 bytes, of which a copied row has a multiple: WebGPU wants 256 bytes."""
_COARSEST = 3
"""The logarithm of the coarsest level's squares along a side."""


class BoundsParams(Struct):
    """The level to compute."""

    side = u32("texels of the map, rounded up to a power of two")
    level = u32()
    layers = u32()
    resolution = u32("texels of the map")


class _Bounds(ComputePass):
    slots = (
        uniform("params", BoundsParams),
        storage("bounds", "vec4u", "read_write"),
    )
    workgroup = (32, 4, 1)
    file = "bounds.wgsl"

    def __init__(self, gpu: Gpu, *, is_first: bool) -> None:
        super().__init__(gpu, generated=f"const IS_FIRST = {str(is_first).lower()};\n")


class DepthBounds:
    """The maps, and (nearest, farthest) of every square of theirs, levels 1 up to 8 x 8 squares.

    A buffer of 2 side^2 words per layer, laid out as in wgsl/shadow_levels.wgsl. Above `top` rays
    have nothing to gain.
    """

    def __init__(self, gpu: Gpu, maps: ShadowMaps) -> None:
        self.maps = maps
        resolution = maps.depth.size[0]
        # Rows of the copied map are a multiple of 256 bytes.
        self.side = max(_ROW_TEXELS, 1 << (max(2, resolution) - 1).bit_length())
        self.top = self.side.bit_length() - 1 - _COARSEST
        layers = max(1, maps.layers)
        self.buffer = Buffer(gpu, "shadow bounds", TEXEL_BYTES * layers * self.side**2)
        # The first level is made of depths, the others of bounds.
        self._first = _Bounds(gpu, is_first=True)
        self._next = _Bounds(gpu, is_first=False)
        self._recorded = Recorded(gpu, "levels of shadow bounds")

    def encode(self, commands: Commands) -> None:
        """Compute all levels from the maps."""
        if not self.maps.layers:
            return
        # The map itself is level 0; the levels above it are recorded once, and replayed.
        self._copy(commands)
        self._recorded.encode(commands, (self.buffer,), partial(self._make_levels, commands))

    def _make_levels(self, commands: Commands) -> None:
        # Each level joins 2 x 2 squares of the one below (Chen2011); level 1 reads the map itself.
        for level in range(1, self.top + 1):
            params = BoundsParams(
                side=self.side,
                level=level,
                layers=self.maps.layers,
                resolution=self.maps.resolution,
            )
            squares = self.side >> level
            (self._first if level == 1 else self._next).dispatch(
                commands,
                (squares // 4, squares, self.maps.layers),
                params=params,
                bounds=self.buffer,
            )

    def _copy(self, commands: Commands) -> None:
        """Level 0: a copy costs a fraction of reading texels in a shader."""
        maps, side = self.maps, self.side
        for layer in range(maps.layers):
            source = {"texture": maps.depth.handle, "origin": (0, 0, layer), "aspect": "depth-only"}
            target = {
                "buffer": self.buffer.handle,
                "offset": TEXEL_BYTES * side * side * layer + 4 * side * side,
                "bytes_per_row": 4 * side,
                "rows_per_image": side,
            }
            commands.encoder.copy_texture_to_buffer(
                source, target, (maps.resolution, maps.resolution, 1)
            )
