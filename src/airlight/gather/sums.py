"""The light along the paths of each gather point, added up."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, texture, uniform
from ..lighting.view import View
from .far import Far
from .paths import Paths
from .points import Points

NBYTES = 144
"""Of a point's sums."""


class SumParams(Struct):
    """Which rays are added; sums begin with ray number `begun`."""

    reduced = vec2u("points")
    rays = u32("of a point")
    first_ray = u32()
    begun = u32()
    texel = f32("m, how wide a texel is one metre away")


class _Sums(ComputePass):
    slots = (
        uniform("params", SumParams),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        storage("paths", "vec4f"),
        storage("met", "u32"),
        storage("far", "f32"),
        storage("sums", "vec4f", "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "sums.wgsl"


class Sums:
    """Nine vec4f for each point.

    The first: radiance of the near surfaces that its rays met, summed, and how many rays met far
    ones. The second: that of the environment, and the sum of its luminance squared. The third:
    where the first's light comes from, as the sum of `maths.gather.flux_along` times its luminance,
    and the share of the hemisphere that near occluders leave. The fourth: where the second's comes
    from, and how many frames before are in the means of `History`. The next two: how near what its
    rays met is, m^-1, as the sums of `maths.gather.nearness`: its squares and how many rays met
    surfaces, and its products. The seventh and eighth: radiance of far surfaces and how many rays
    met them; where it comes from, and the inverse lengths of those rays, m^-1. The last: the
    normals that rays met over their lengths, m^-1.

    Near and far are apart, since light from afar is alike at more of a point's neighbours: they
    share its mean radiance, times the share of rays that a point's closer neighbours send so far.
    """

    def __init__(self, gpu: Gpu, points: Points) -> None:
        self._points, self._pass, self._far = points, _Sums(gpu), Far(gpu, points)
        self.buffer = Buffer(gpu, "gathered sums", NBYTES * points.count)

    def encode(
        self, commands: Commands, view: View, paths: Paths, numbers: range, sample: range
    ) -> None:
        """Add the `paths` of the rays of these `numbers`.

        `sample`: the numbers of all rays of this sample of the image.
        """
        if numbers.start == sample.start:
            self._far.encode(commands, view)
        self._pass.dispatch(
            commands,
            self._points.reduced,
            params=SumParams(
                reduced=self._points.reduced,
                rays=len(numbers),
                first_ray=numbers.start,
                begun=sample.start,
                texel=self._points.texel_m(view),
            ),
            places=self._points.places,
            normals=self._points.normals,
            paths=paths.buffer,
            met=paths.met,
            far=self._far.buffer,
            sums=self.buffer,
        )
