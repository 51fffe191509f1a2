"""A reduced image of shafts from sparse samples: one texel in four, and the others between them.

Every second texel of every second row is sampled, even and odd ones in turn. A texel between
samples of its own depth that are alike is their mean; others are listed, and sampled too.
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Texture
from ...gpu.slots import image, storage, texture, uniform
from ..pixel_list import PixelList, RedrawParams, pixel_list_slots
from ..rays import RayParams, Rays
from .shadow_rays import ShadowRays

SAMPLE_CONTRAST = 0.3
"""The contrast that sparse samples may have, as a share of that between texels of a reduced image:
samples are farther apart."""
SAMPLE_SPACING = 2
"""Texels of the reduced image from one sample to the next in its row."""


class _Samples(ComputePass):
    workgroup = (8, 8, 1)
    file = "sparse_samples.wgsl"

    def __init__(self, shadows: ShadowRays) -> None:
        self.slots = shadows.slots(  # type: ignore[misc]
            texture("picked", "2d", "unfilterable-float")
        )
        super().__init__(shadows.gpu, generated=shadows.wgsl)


class _Interpolate(ComputePass):
    slots = (
        uniform("rays", RayParams),
        texture("picked", "2d", "unfilterable-float"),
        texture("samples", "2d", "unfilterable-float"),
        *pixel_list_slots(),
        image("scattered", "rgba32float"),
    )
    workgroup = (8, 8, 1)
    file = "sparse_interpolate.wgsl"


class _Redraw(ComputePass):
    workgroup = (64, 1, 1)
    file = "redraw_texels.wgsl"

    def __init__(self, shadows: ShadowRays) -> None:
        self.slots = shadows.slots(  # type: ignore[misc]
            storage("found", "u32"),
            storage("chosen", "vec4u"),
            texture("picked", "2d", "unfilterable-float"),
        )
        super().__init__(shadows.gpu, generated=shadows.wgsl)


class SparseShafts:
    """Fills a reduced image from sparse samples."""

    def __init__(self, shadows: ShadowRays, rays: Rays) -> None:
        """For the reduced images of `rays`."""
        self._gpu, self._rays = shadows.gpu, rays
        self._sample, self._interpolate = _Samples(shadows), _Interpolate(shadows.gpu)
        self._redraw = _Redraw(shadows)
        self._listed = PixelList(shadows.gpu, rays.reduced)
        self._make()

    def _make(self) -> None:
        width, height = self._rays.reduced
        self._size = ((width + 1) // 2, (height + 1) // 2)
        self._samples = Texture(self._gpu, "sparse shafts", self._size, "rgba32float", written=True)

    def resize(self) -> None:
        """Go on with images of the size of the rays."""
        self._samples.release()
        self._listed.resize(self._rays.reduced)
        self._make()

    def encode(
        self, commands: Commands, scattered: Texture, contrast: float, bound: dict[str, Any]
    ) -> None:
        """Fill `scattered`; `contrast`: of a reduced image; `bound`: as `ShadowRays.bound`."""
        rays = self._rays
        # One texel in four.
        self._sample.dispatch(
            commands, self._size, scattered=self._samples, picked=rays.picked, **bound
        )
        # The others: means, or listed.
        self._listed.begin(commands)
        self._interpolate.dispatch(
            commands,
            rays.reduced,
            rays=bound["rays"],
            picked=rays.picked,
            samples=self._samples,
            redrawn=RedrawParams.of(
                contrast=SAMPLE_CONTRAST * contrast, group=self._redraw.workgroup[0]
            ),
            scattered=scattered,
            **self._listed.bound,
        )
        # Those that are listed.
        self._redraw.dispatch_indirect(
            commands,
            self._listed.groups,
            found=self._listed.found,
            chosen=self._listed.chosen,
            picked=rays.picked,
            scattered=scattered,
            **bound,
        )
