"""The tone-mapped image on a surface: stretched to it, encoded as its format needs."""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture, linear_sampler
from ..gpu.raster import FullscreenPass
from ..gpu.slots import sampler, texture


class _Show(FullscreenPass):
    vertex_entry = "vertex"
    slots = (texture("shown", "2d", "float"), sampler("linear_clamp"))
    file = "show.wgsl"


class Show:
    """Draws onto views of textures of one `format`; one that ends in -srgb encodes by itself."""

    def __init__(self, gpu: Gpu, format: str) -> None:
        self._pass = _Show(
            gpu, targets=(format,), constants={"is_encoding": float(format.endswith("-srgb"))}
        )
        self._linear = linear_sampler(gpu, "show")

    def draw(self, commands: Commands, shown: Texture, view: Any) -> None:
        """Fill `view`, a surface of any size, with `shown`, sRGB-encoded."""
        self._pass.draw(commands, (view,), shown=shown, linear_clamp=self._linear)
