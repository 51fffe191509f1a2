"""The sum of states that surfaces read, and the tail: what all later states would add."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .storage import FLOAT, Format

_PER_INVOCATION = 16  # values, so that a grid of 256^3 cells has few enough workgroups


class AccumulateParams(Struct):
    """The lattice's size."""

    values = u32("vec4 values in the lattice")
    is_tail = u32("1: add what the states after this block would add")
    is_first = u32("1: the total begins with this state")


class PowerParams(Struct):
    """A lattice, and where its power goes."""

    cells = u32()
    slot = u32("of `powers`")


class Sums:
    """Sums of states stored in a format; `range` as `storage.Pack` finds it."""

    def __init__(self, gpu: Gpu, cells: int, format: Format, range: Buffer) -> None:
        self._cells, self._range = cells, range
        self._powers = Buffer(gpu, "power of the last blocks", 32)
        self._power = _power_pass(gpu, format)
        self._accumulate = _accumulate_pass(gpu, format)

    def add_to_total(
        self,
        commands: Commands,
        state: Buffer,
        total: Buffer,
        *,
        is_tail: bool = False,
        is_first: bool = False,
    ) -> None:
        """total += state (float32, W sr^-1).

        `is_first`: total = state. `is_tail`: the state is the last block, and what is added is the
        sum of all blocks after it, which shrink by the ratio of the two powers measured.
        """
        # Three colour channels, one vec4 of each cell.
        values = 3 * self._cells
        self._accumulate.dispatch(
            commands,
            (-(-values // _PER_INVOCATION),),
            params=AccumulateParams.of(values=values, is_tail=int(is_tail), is_first=int(is_first)),
            state=state,
            powers=self._powers,
            range=self._range,
            total=total,
        )

    def measure(self, commands: Commands, block: Buffer, slot: int) -> None:
        """Store the power of the last block but one (slot 0) or of the last (slot 1)."""
        self._power.dispatch(
            commands,
            (1,),
            params=PowerParams.of(cells=self._cells, slot=slot),
            state=block,
            powers=self._powers,
        )


def _power_pass(gpu: Gpu, format: Format) -> ComputePass:
    """The power of a lattice, per channel, always added in the same order."""

    class Power(ComputePass):
        slots = (
            uniform("params", PowerParams),
            storage("state", format.element),
            storage("powers", "vec4f", "read_write"),
        )
        workgroup = (256, 1, 1)
        file = "power.wgsl"

    return Power(gpu, generated=format.wgsl)


def _accumulate_pass(gpu: Gpu, format: Format) -> ComputePass:
    class Accumulate(ComputePass):
        slots = (
            uniform("params", AccumulateParams),
            storage("state", format.element),
            storage("powers", "vec4f"),
            storage("range", "f32"),
            storage("total", "vec4f", "read_write"),
        )
        workgroup = (256, 1, 1)
        file = "accumulate.wgsl"

    # Floats are added as they are; other formats are scaled back from their range.
    constants = {
        "IS_SCALED": float(format is not FLOAT),
        "PER_INVOCATION": float(_PER_INVOCATION),
    }
    return Accumulate(gpu, constants=constants, generated=format.wgsl)
