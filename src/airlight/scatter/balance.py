"""The sum of all states scaled so that all light that came in has been lost somewhere.

Of Q = I + M Q a sum Q has lost the power of Q - M Q to air, walls and the world outside; in the end
that is all of I. What is under way after a few cycles is smooth and wanders on where the sum
already is, so a scale is what it lacks most. Another step costs nothing more: I + s M Q.
Source: the coarsest correction of iterative aggregation (Koury, McAllister and Stewart 1984).
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS
from .propagate import Count

_PARTS = 512  # partial sums of a channel
_MOST = 2.0  # a scale beyond which a sum knows too little of where light goes


class BalanceParams(Struct):
    """The lattice's size."""

    count = vec3u("cells")


_PARAMS = uniform("params", BalanceParams)


class _Sum(ComputePass):
    slots = (
        _PARAMS,
        storage("source", "vec4f"),
        storage("stepped", "vec4f"),
        storage("sum", "vec4f"),
        storage("parts", "vec2f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "balance_sum.wgsl"


class _Scale(ComputePass):
    slots = (storage("parts", "vec2f"), storage("scales", "f32", "read_write"))
    workgroup = (4, 1, 1)
    file = "balance_scale.wgsl"


class _Apply(ComputePass):
    slots = (
        _PARAMS,
        storage("source", "vec4f"),
        storage("stepped", "vec4f"),
        storage("scales", "f32"),
        storage("balanced", "vec4f", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "balance_apply.wgsl"


class Balance:
    """Finds the scale per channel and takes the scaled sum one step on."""

    def __init__(self, gpu: Gpu) -> None:
        parts = f"const PARTS = {_PARTS}u;\nconst MOST = {_MOST};"
        self._sum, self._scale = _Sum(gpu, generated=parts), _Scale(gpu, generated=parts)
        self._apply = _Apply(gpu)
        self._parts = Buffer(gpu, "partial powers", CHANNELS * _PARTS * 8)
        self.scales = Buffer(gpu, "scales of the sum", CHANNELS * 4)

    def encode(
        self,
        commands: Commands,
        count: Count,
        *,
        source: Buffer,
        current: Buffer,
        stepped: Buffer,
    ) -> Buffer:
        """`current` becomes source + s (stepped - source); `stepped` = source + M current."""
        nx, ny, nz = count
        params = BalanceParams(count=count)
        self._sum.dispatch(
            commands,
            (_PARTS, CHANNELS),
            params=params,
            source=source,
            stepped=stepped,
            sum=current,
            parts=self._parts,
        )
        self._scale.dispatch(commands, (CHANNELS,), parts=self._parts, scales=self.scales)
        self._apply.dispatch(
            commands,
            (nx, ny, CHANNELS * nz),
            params=params,
            source=source,
            stepped=stepped,
            scales=self.scales,
            balanced=current,
        )
        return current
