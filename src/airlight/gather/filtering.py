"""Light of gather points shared between neighbours, and brought to the pixels of the image."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import image, storage, texture, uniform
from ..lighting.gathered import Gathered
from ..lighting.view import View
from .points import PointParams, Points

STRIDES = (1, 2, 4)
"""Texels between the points of each pass."""
WIDTH = 1.6
"""Deviation of the weights of a pass in the first sample of a still, in strides."""


class FilterParams(Struct):
    """How far apart points are, and how fast weights fall off."""

    reduced = vec2u("points")
    stride = u32("texels")
    falloff = f32("per squared stride")
    texel = f32("m, how wide a texel is one metre away")
    pad = u32()


class _Filter(ComputePass):
    slots = (
        uniform("params", FilterParams),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        storage("before", "vec4f"),
        storage("after", "vec4f", "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "filter.wgsl"


class _Upsample(ComputePass):
    slots = (
        uniform("params", PointParams),
        texture("depth", "2d", "depth"),
        texture("normal", "2d", "unfilterable-float"),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        storage("sums", "vec4f"),
        image("irradiance", "rgba16float"),
        image("irradiance_of_sky", "rgba16float"),
    )
    workgroup = (8, 8, 1)
    file = "upsample.wgsl"


class Filtering:
    """Sums of points -> irradiance of pixels."""

    def __init__(self, gpu: Gpu, points: Points) -> None:
        self._points = points
        self._filter, self._upsample = _Filter(gpu), _Upsample(gpu)
        self._between = [
            Buffer(gpu, f"filtered sums {i}", 32 * points.count) for i in range(len(STRIDES))
        ]
        irradiance, sky = (
            Texture(gpu, label, points.size, "rgba16float", written=True)
            for label in ("gathered irradiance", "gathered sky")
        )
        self.gathered = Gathered(irradiance, sky)

    def encode(self, commands: Commands, view: View, sums: Buffer) -> Gathered:
        """The irradiance of the view's pixels; `sums` of its points, as `Sums` has them."""
        points = self._points
        params = points.params(view)
        for stride, after in zip(STRIDES, self._between, strict=True):
            self._filter.dispatch(
                commands,
                points.reduced,
                params=FilterParams(
                    reduced=points.reduced,
                    stride=stride,
                    falloff=falloff(view.sample),
                    texel=points.texel_m(view),
                    pad=0,
                ),
                places=points.places,
                normals=points.normals,
                before=sums,
                after=after,
            )
            sums = after
        self._upsample.dispatch(
            commands,
            points.size,
            params=params,
            depth=view.gbuffer.depth,
            normal=view.gbuffer.normal,
            places=points.places,
            normals=points.normals,
            sums=sums,
            irradiance=self.gathered.irradiance,
            irradiance_of_sky=self.gathered.sky,
        )
        return self.gathered


def falloff(sample: int) -> float:
    """How fast weights fall off in a sample of a still, per squared stride.

    Filters narrow from sample to sample, so that their blur goes from the mean while its noise goes
    on falling: their area shrinks as n^(-1/2). Source: Knaus2011 (the radii of
    progressive photon mapping with alpha = 1/2).
    """
    return float((sample + 1) ** 0.5 / (2.0 * WIDTH**2))
