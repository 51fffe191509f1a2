"""Exposure metered on the device: the twin of `maths.tone.auto_exposure`."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, vec2u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform


class MeterParams(Struct):
    """The image's size, and how fast the exposure follows."""

    size = vec2u("px")
    speed = f32("share of the way to the new exposure; 1 at once")


class _Meter(ComputePass):
    slots = (
        uniform("params", MeterParams),
        texture("image", "2d", "unfilterable-float"),
        storage("metered", "f32", "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "meter.wgsl"


class Meter:
    """`stops` holds one float: the exposure that brings the image to middle grey.

    differs: a histogram of sixteenths of a stop, over a grid of pixels, instead of a sort.
    """

    def __init__(self, gpu: Gpu) -> None:
        self._pass = _Meter(gpu)
        self.stops = Buffer(gpu, "metered exposure", 16)

    def encode(self, commands: Commands, image: Texture, speed: float = 1.0) -> None:
        """Meter `image`, radiance."""
        # One workgroup, whose lanes share the histogram.
        params = MeterParams(size=image.size[:2], speed=speed)
        self._pass.dispatch(commands, (256,), params=params, image=image, metered=self.stops)
