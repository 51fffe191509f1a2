"""Global power rescaling: the sum of all states, scaled so that all power that came in is lost.

Of Q = I + M Q a sum Q has lost the power of Q - M Q to media, walls and the world outside; in the
end that is all of I. What is still under way is a smooth global mode, which a scale per channel
corrects. Another step costs nothing more: I + s M Q.
Source: the coarsest correction of iterative aggregation (Koury1984).
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeSize
from .coefficients import CHANNELS
from .propagate import Count

_PARTS = 512  # partial sums of a channel
_MOST = 2.0  # a scale beyond which a sum knows too little of where light goes

_PARAMS = uniform("params", LatticeSize)
_SOURCE, _STEPPED, _SUM = (storage(name, "vec4f") for name in ("source", "stepped", "sum"))


class _Sum(ComputePass):
    slots = (_PARAMS, _SOURCE, _STEPPED, _SUM, storage("parts", "vec2f", "read_write"))
    workgroup = (64, 1, 1)
    file = "power_sum.wgsl"


class _Scale(ComputePass):
    slots = (storage("parts", "vec2f"), storage("scales", "f32", "read_write"))
    workgroup = (4, 1, 1)
    file = "power_scale.wgsl"


class _Apply(ComputePass):
    slots = (
        _PARAMS,
        _SOURCE,
        _STEPPED,
        storage("scales", "f32"),
        storage("rescaled", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "power_apply.wgsl"


class PowerRescaling:
    """Finds the scale per channel and takes the scaled sum one step on."""

    def __init__(self, gpu: Gpu) -> None:
        parts = f"const PARTS = {_PARTS}u;\nconst MOST = {_MOST};"
        # Sums in two steps, in a fixed order, and the scale that follows from them.
        self._sum, self._scale = _Sum(gpu, generated=parts), _Scale(gpu, generated=parts)
        self._apply = _Apply(gpu)
        self._parts = Buffer(gpu, "partial powers", CHANNELS * _PARTS * 8)
        self.scales = Buffer(gpu, "scales of the sum", CHANNELS * 4)

    def encode(
        self, commands: Commands, count: Count, source: Buffer, *, current: Buffer, stepped: Buffer
    ) -> None:
        """`current` becomes source + s (stepped - source); `stepped` = source + M current."""
        params = LatticeSize(count=count)
        # What came in, and what of it is still under way.
        self._sum.dispatch(
            commands,
            (_PARTS, CHANNELS),
            params=params,
            source=source,
            stepped=stepped,
            sum=current,
            parts=self._parts,
        )
        # One factor for each channel of the whole lattice: the coarsest aggregation there is.
        self._scale.dispatch(commands, (CHANNELS,), parts=self._parts, scales=self.scales)
        self._apply.dispatch(
            commands,
            (*count[:2], CHANNELS * count[2]),
            params=params,
            source=source,
            stepped=stepped,
            scales=self.scales,
            rescaled=current,
        )
