"""The light along the paths of each gather point, added up by how far it comes."""

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

NBYTES = 176
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
        storage("paths", "vec4f", "read_write"),
        storage("met", "u32"),
        storage("far", "f32"),
        storage("sums", "vec4f", "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "sums.wgsl"


class _LaterSums(ComputePass):
    slots = (
        uniform("params", SumParams),
        texture("normals", "2d", "unfilterable-float"),
        storage("paths", "vec4f"),
        storage("far", "f32"),
        storage("sums", "vec4f", "read_write"),
    )
    workgroup = (8, 8, 1)
    file = "later_sums.wgsl"


class Sums:
    """Eleven vec4f for each point.

    The first: radiance that first segments found at near surfaces, summed, and how many rays met
    far ones. The second: that of the environment, and the sum of its luminance squared. The third:
    where the first's light comes from, as the sum of `maths.gather.flux_along` times its luminance,
    and the share of the hemisphere that near occluders leave. The fourth: where the second's comes
    from, and how many frames before are in the means of `History`. The next two: how near what its
    rays met is, m^-1, as the sums of `maths.gather.nearness`: its squares and how many rays met
    surfaces, and its products. The seventh and eighth: radiance of far surfaces and how many rays
    met them; where it comes from, and the inverse lengths of those rays, m^-1. The ninth: the
    normals that rays met over their lengths, m^-1, and the inverse length at which far begins.
    The last two: radiance that later segments brought to near surfaces, and how many rays met such;
    where it comes from.

    The three kinds are apart, since light from afar, and what near surfaces reflect of it, are
    alike at more of a point's neighbours than what lights shine on near surfaces. Of these two a
    point takes the mean radiance of many neighbours, times the share of rays that its closer ones
    send so far.
    """

    def __init__(self, gpu: Gpu, points: Points) -> None:
        self._points, self._far = points, Far(gpu, points)
        self._pass, self._later = _Sums(gpu), _LaterSums(gpu)
        self.buffer = Buffer(gpu, "gathered sums", NBYTES * points.count)

    def encode(
        self, commands: Commands, view: View, paths: Paths, numbers: range, sample: range
    ) -> None:
        """Add what the first segments of the `paths` of the rays of these `numbers` found.

        `sample`: the numbers of all rays of this sample of the image. The paths go on without it.
        """
        if numbers.start == sample.start:
            self._far.encode(commands, view)
        self._pass.dispatch(
            commands,
            self._points.reduced,
            params=self._params(view, numbers, sample),
            places=self._points.places,
            normals=self._points.normals,
            paths=paths.buffer,
            met=paths.met,
            far=self._far.buffer,
            sums=self.buffer,
        )

    def encode_later(self, commands: Commands, view: View, paths: Paths, numbers: range) -> None:
        """Add what all later segments found."""
        self._later.dispatch(
            commands,
            self._points.reduced,
            params=self._params(view, numbers, numbers),
            normals=self._points.normals,
            paths=paths.buffer,
            far=self._far.buffer,
            sums=self.buffer,
        )

    def _params(self, view: View, numbers: range, sample: range) -> SumParams:
        return SumParams(
            reduced=self._points.reduced,
            rays=len(numbers),
            first_ray=numbers.start,
            begun=sample.start,
            texel=self._points.texel_m(view),
        )
