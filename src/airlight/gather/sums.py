"""The light along the paths of each gather point, added up."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32, vec2u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, texture, uniform
from .points import Points

NBYTES = 64
"""Of a point's sums."""


class SumParams(Struct):
    """Which rays are added; sums begin with ray number `begun`."""

    reduced = vec2u("points")
    rays = u32("of a point")
    first_ray = u32()
    begun = u32()
    pad = u32()


class _Sums(ComputePass):
    slots = (
        uniform("params", SumParams),
        texture("normals", "2d", "unfilterable-float"),
        storage("paths", "vec4f"),
        storage("sums", "vec4f", "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "sums.wgsl"


class Sums:
    """Four vec4f for each point.

    The first: radiance of the surfaces that its rays met, summed, and the sum of their distances'
    inverses, m^-1. The second: that of the environment, and the sum of its luminance squared. The
    third: where the first's light comes from, as the sum of `maths.gather.flux_along` times its
    luminance, and the share of the hemisphere that near occluders leave. The fourth: where the
    second's comes from, and how many frames before are in the means of `History`.
    """

    def __init__(self, gpu: Gpu, points: Points) -> None:
        self._points, self._pass = points, _Sums(gpu)
        self.buffer = Buffer(gpu, "gathered sums", NBYTES * points.count)

    def encode(self, commands: Commands, paths: Buffer, numbers: range, sample: range) -> None:
        """Add the `paths` of the rays of these `numbers`.

        `sample`: the numbers of all rays of this sample of the image.
        """
        self._pass.dispatch(
            commands,
            self._points.reduced,
            params=SumParams(
                reduced=self._points.reduced,
                rays=len(numbers),
                first_ray=numbers.start,
                begun=sample.start,
                pad=0,
            ),
            normals=self._points.normals,
            paths=paths,
            sums=self.buffer,
        )
