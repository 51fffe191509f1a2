"""Single scattering by jittered steps: the cheap scheme.

Rays are cut into equal steps (of at least a voxel inside grids). Each step takes one sample per
light, at an offset that differs over every 4 x 4 pixels, and `blur` removes the pattern. 1/r^2 is
integrated exactly over each step (Kulla2012).
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32
from ...gpu.memory import Texture
from ...gpu.slots import image, texture, uniform
from ...lighting.lights import Lights
from ...surface.light_table import SHADOWED_LIGHT_SLOTS
from ..gpu_media import GpuMedia
from ..rays import RayParams, Rays
from .blur import Blur


class JitterParams(Struct):
    """How many lights and steps."""

    light_count = u32()
    steps = u32()


class _Jitter(ComputePass):
    workgroup = (8, 8, 1)
    file = "jitter.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self.slots = (
            uniform("rays", RayParams),
            uniform("params", JitterParams),
            texture("picked", "2d", "unfilterable-float"),
            *media.slots,
            *SHADOWED_LIGHT_SLOTS,
            image("scattered", "rgba32float"),
        )
        super().__init__(gpu, generated=media.wgsl)


class Jitter:
    """The scheme `jitter`, for any media."""

    def __init__(self, gpu: Gpu, media: GpuMedia, rays: Rays, *, steps: int = 32) -> None:
        self.media, self.rays, self.steps = media, rays, steps
        self._pass, self._blur = _Jitter(gpu, media), Blur(gpu)
        self._make_raw()

    def _make_raw(self) -> None:
        gpu, size = self.media.gpu, self.rays.reduced
        self._raw = Texture(gpu, "jittered", size, "rgba32float", written=True)

    def resize(self) -> None:
        """Go on with images of the size of the rays."""
        self._raw.release()
        self._make_raw()

    def prepare(self, commands: Commands) -> None:
        """Nothing to make beforehand."""

    def encode(self, commands: Commands, lights: Lights, scattered: Texture) -> None:
        """Fill `scattered`, of the size of `rays.reduced`: radiance, W m^-2 sr^-1."""
        # A sample per step, at one of 16 offsets; then the mean over all of them.
        self._pass.dispatch(
            commands,
            self.rays.reduced,
            rays=self.rays.params,
            picked=self.rays.picked,
            params=JitterParams(light_count=lights.count, steps=self.steps),
            **self.media.bound,
            lights=lights.table,
            parallel_views=lights.parallel.views,
            local_views=lights.local.views,
            parallel_shadows=lights.parallel.depth,
            local_shadows=lights.local.depth,
            shadow_compare=lights.parallel.sampler,
            scattered=self._raw,
        )
        self._blur.encode(commands, self.rays, self._raw, scattered)
