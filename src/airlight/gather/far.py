"""Where light from afar begins, for all gather points of an image alike."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, texture, uniform
from ..lighting.view import View
from .points import Points


class FarParams(Struct):
    """How many points there are, and how wide."""

    reduced = vec2u("points of blocks")
    texel = f32("m, how wide a texel is one metre away")
    pad = u32()


class _Far(ComputePass):
    slots = (
        uniform("params", FarParams),
        texture("places", "2d", "unfilterable-float"),
        storage("far", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "far.wgsl"


class Far:
    """A length, m: what longer rays meet is far (`maths.gather.FAR`)."""

    def __init__(self, gpu: Gpu, points: Points) -> None:
        self._points, self._pass = points, _Far(gpu)
        self.buffer = Buffer(gpu, "where far begins", 16)

    def encode(self, commands: Commands, view: View) -> None:
        """Find it; the view's points are known."""
        # One workgroup, one length for the whole image.
        self._pass.dispatch(
            commands,
            (64,),
            params=FarParams(reduced=self._points.blocks, texel=self._points.texel_m(view), pad=0),
            places=self._points.places,
            far=self.buffer,
        )
