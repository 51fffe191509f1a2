"""The mean of 4 x 4 texels of about the same depth, which removes a 4 x 4 pattern of jitter."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Texture
from ...gpu.slots import image, texture, uniform
from ..rays import RayParams, Rays


class Blur(ComputePass):
    """Jittered radiance -> mean over every 16 phases of the jitter."""

    slots = (
        uniform("rays", RayParams),
        texture("picked", "2d", "unfilterable-float"),
        texture("jittered", "2d", "unfilterable-float"),
        image("scattered", "rgba32float"),
    )
    workgroup = (16, 8, 1)

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        jittered: Texture,
        scattered: Texture,
    ) -> None:
        """Fill `scattered` from `jittered`, both of the size of `rays.reduced`."""
        self.dispatch(
            commands,
            rays.reduced,
            rays=rays.params,
            picked=rays.picked,
            jittered=jittered,
            scattered=scattered,
        )
