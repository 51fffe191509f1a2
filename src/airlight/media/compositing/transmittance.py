"""The transmittance of homogeneous media to the surface of every pixel, in closed form.

Source: Beer-Lambert, over the stretch of the eye ray in each medium.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.fullscreen import FullscreenPass
from ...gpu.memory import Texture
from ...gpu.slots import texture, uniform
from ..gpu_media import GpuMedia
from ..rays import RayParams, Rays


class Transmittance(FullscreenPass):
    """Depth -> transmittance of the eye ray, rgb."""

    targets = ("rgba32float",)

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (
            uniform("rays", RayParams),
            texture("depth", "2d", "depth"),
            *media.medium_slots,
        )
        self._media = media
        super().__init__(gpu, generated=media.medium_wgsl)

    def encode(self, commands: Commands, rays: Rays, depth: Texture, target: Texture) -> None:
        """Fill `target`."""
        self.draw(commands, (target,), rays=rays.params, depth=depth, **self._media.medium_bound)
