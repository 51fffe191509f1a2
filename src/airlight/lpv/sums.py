"""Adding states to the sum that surfaces see, and what all later states would add."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .storage import FLOAT, Format

_CPU_PER_LANE = 16  # values: a CPU adapter takes 7 ns to begin an invocation


class AccumulateParams(Struct):
    """The lattice's size."""

    values = u32("vec4 values in the lattice")
    is_tail = u32("1: add what the states after this block would add")
    is_first = u32("1: whatever the total was is forgotten")


class PowerParams(Struct):
    """What is summed, and where the sum goes."""

    cells = u32()
    place = u32("in `powers`")


class Sums:
    """Sums of states stored in a format; `range` as `storage.Pack` finds it."""

    def __init__(self, gpu: Gpu, cells: int, format: Format, range: Buffer) -> None:
        self._cells, self._range = cells, range
        self._per_lane = _CPU_PER_LANE if gpu.takes_cpu_paths else 1
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
        """total += state (float32, W sr^-1), or what all blocks after it would be.

        `is_first`: total = state.

        The ratio of the two powers that were measured says how blocks shrink.
        """
        values = 3 * self._cells
        self._accumulate.dispatch(
            commands,
            (-(-values // self._per_lane),),
            params=AccumulateParams.of(values=values, is_tail=int(is_tail), is_first=int(is_first)),
            state=state,
            powers=self._powers,
            range=self._range,
            total=total,
        )

    def measure(self, commands: Commands, block: Buffer, place: int) -> None:
        """Remember the power of the last block but one (place 0) or of the last (1)."""
        self._power.dispatch(
            commands,
            (1,),
            params=PowerParams.of(cells=self._cells, place=place),
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

    constants = {
        "IS_SCALED": float(format is not FLOAT),
        "PER_LANE": float(_CPU_PER_LANE if gpu.takes_cpu_paths else 1),
    }
    return Accumulate(gpu, constants=constants, generated=format.wgsl)
