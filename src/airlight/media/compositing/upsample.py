"""A reduced image at full size: bilinear among texels of about the depth of the pixel.

Source: Kopf2007 (joint bilateral upsampling), with depth as the guide.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.fullscreen import FullscreenPass
from ...gpu.memory import Texture
from ...gpu.slots import texture, uniform
from ..rays import RayParams, Rays

_SLOTS = (
    uniform("rays", RayParams),
    texture("depth", "2d", "depth"),
    texture("picked", "2d", "unfilterable-float"),
    texture("reduced", "2d", "unfilterable-float"),
)


class Upsample(FullscreenPass):
    """Full-size target <- reduced image, its rays and the depth of the full one."""

    slots = _SLOTS
    targets = ("rgba32float",)

    def __init__(self, gpu: Gpu) -> None:
        super().__init__(gpu, generated="fn base_at(pixel: vec2i) -> vec4f { return vec4f(0.0); }")

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        depth: Texture,
        reduced: Texture,
        target: Texture,
    ) -> None:
        """Fill `target` from `reduced`, the image of `rays`."""
        self.draw(
            commands, (target,), rays=rays.params, depth=depth, picked=rays.picked, reduced=reduced
        )


class UpsampleOnto(FullscreenPass):
    """The same, added to a full-size image."""

    slots = (*_SLOTS, texture("base", "2d", "unfilterable-float"))
    targets = ("rgba32float",)
    file = "upsample.wgsl"

    def __init__(self, gpu: Gpu) -> None:
        loaded = "fn base_at(pixel: vec2i) -> vec4f { return textureLoad(base, pixel, 0); }"
        super().__init__(gpu, generated=loaded)

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        depth: Texture,
        reduced: Texture,
        base: Texture,
        target: Texture,
    ) -> None:
        """`target` = `base` + `reduced`."""
        self.draw(
            commands,
            (target,),
            rays=rays.params,
            depth=depth,
            picked=rays.picked,
            reduced=reduced,
            base=base,
        )
