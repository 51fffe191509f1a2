"""Light of gather points shared between neighbours."""

from __future__ import annotations

from itertools import cycle

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u
from ..gpu.memory import Texture
from ..gpu.slots import storage, texture, uniform
from ..lighting.view import View
from .points import Points
from .sums import read_sums, sums_image, written_sums

STRIDES = (1, 2, 4)
"""Texels between the points of each pass."""
WIDTH = 1.2
"""Deviation of the weights of a pass where points have sixteen rays, in strides."""


class FilterParams(Struct):
    """How far apart points are, and how fast weights fall off."""

    reduced = vec2u("blocks of pixels")
    rows = u32("of points, orphans' below those of the blocks")
    stride = u32("texels")
    falloff = f32("per squared stride")
    texel = f32("m, how wide a texel is one metre away")
    rays = u32("of a point, by the cosine")
    sky_rays = u32("of a point, towards what is bright of the sky")
    is_last = u32("1 in the last pass, which puts near and far together")
    pad = u32()


class _Filter(ComputePass):
    slots = (
        uniform("params", FilterParams),
        texture("places", "2d", "unfilterable-float"),
        texture("planes", "2d", "unfilterable-float"),
        storage("orphans", "u32"),
        read_sums("before"),
        written_sums(),
    )
    workgroup = (8, 8, 1)
    in_bands = True
    file = "filter.wgsl"


class Filtering:
    """Sums of points -> their means over neighbours."""

    def __init__(self, gpu: Gpu, points: Points, rays: int) -> None:
        """`rays`: of a point."""
        self._points, self._rays = points, rays
        self._filter = _Filter(gpu)
        # Each pass reads what the one before has written, in turn.
        self._images = [sums_image(gpu, f"filtered sums {i}", points) for i in range(2)]

    def encode(self, commands: Commands, view: View, sums: Texture, sky_rays: int) -> Texture:
        """The filtered `sums` of a view's points, both images of them.

        `sky_rays`: of a point, beside those by the cosine.
        """
        points = self._points
        # Edge-avoiding a-trous passes (Dammertz2010): few taps, farther apart in each pass.
        for stride, after in zip(STRIDES, cycle(self._images), strict=False):
            self._filter.dispatch(
                commands,
                points.reduced,
                params=FilterParams(
                    reduced=points.blocks,
                    rows=points.reduced[1],
                    stride=stride,
                    falloff=falloff((view.sample + 1) * self._rays),
                    texel=points.texel_m(view),
                    rays=self._rays,
                    sky_rays=sky_rays,
                    is_last=int(stride == STRIDES[-1]),
                    pad=0,
                ),
                places=points.places,
                planes=points.planes,
                orphans=points.orphans.buffer,
                before=sums,
                sums_after=after,
            )
            sums = after
        return sums

    @property
    def spare(self) -> Texture:
        """The image that does not hold what `encode` returned."""
        return self._images[len(STRIDES) % 2]


def falloff(rays: int) -> float:
    """How fast weights fall off once a still has so many `rays` of a point, per squared stride.

    Filters narrow from sample to sample, so that their blur goes from the mean while its noise goes
    on falling: their area shrinks as n^(-1/2). Source: Knaus2011 (the radii of
    progressive photon mapping with alpha = 1/2).
    """
    return float((rays / 16.0) ** 0.5 / (2.0 * WIDTH**2))
