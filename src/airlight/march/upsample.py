"""A reduced picture at full size: bilinear among texels of about the pixel's own depth.

Source: Kopf et al. 2007 (joint bilateral upsampling), with depth as the guide.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.memory import Texture
from ..gpu.raster import FullscreenPass
from ..gpu.slots import texture, uniform
from .rays import RayParams, Rays


class Upsample(FullscreenPass):
    """Full-size target <- reduced picture, its rays and the picture's depth."""

    slots = (
        uniform("rays", RayParams),
        texture("depth", "2d", "depth"),
        texture("picked", "2d", "unfilterable-float"),
        texture("reduced", "2d", "unfilterable-float"),
    )
    targets = ("rgba32float",)

    def encode(
        self, commands: Commands, params: RayParams, rays: Rays, depth: Texture,
        reduced: Texture, target: Texture,
    ) -> None:  # fmt: skip
        """Fill `target` from `reduced`; `params` as `rays.encode` gave them."""
        self.draw(
            commands, (target,), rays=params, depth=depth, picked=rays.picked, reduced=reduced
        )
