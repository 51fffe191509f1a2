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


class Upsample(FullscreenPass):
    """Full-size target <- reduced image, its rays and the depth of the full one.

    `is_added`: added to a full-size image.
    """

    targets = ("rgba32float",)

    def __init__(self, gpu: Gpu, *, is_added: bool = False) -> None:
        self.slots = (
            uniform("rays", RayParams),
            texture("depth", "2d", "depth"),
            texture("picked", "2d", "unfilterable-float"),
            texture("reduced", "2d", "unfilterable-float"),
            *(texture("base", "2d", "unfilterable-float"),) * is_added,
        )
        base = "textureLoad(base, pixel, 0)" if is_added else "vec4f(0.0)"
        super().__init__(gpu, generated=f"fn base_at(pixel: vec2i) -> vec4f {{ return {base}; }}")

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        depth: Texture,
        reduced: Texture,
        target: Texture,
        base: Texture | None = None,
    ) -> None:
        """Fill `target` from `reduced`, the image of `rays`; where it `is_added`, to `base`."""
        self.draw(
            commands,
            (target,),
            rays=rays.params,
            depth=depth,
            picked=rays.picked,
            reduced=reduced,
            **({"base": base} if base else {}),
        )
