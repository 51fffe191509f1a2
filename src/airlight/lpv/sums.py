"""Adding states to the sum that surfaces see, and what all later states would add."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .storage import FORMATS, Format

FLOAT = FORMATS["float32"]


class AccumulateParams(Struct):
    """The lattice's size."""

    values = u32("vec4 values in the lattice")
    is_tail = u32("1: add what the states after this block would add")


class PowerParams(Struct):
    """What is summed, and where the sum goes."""

    cells = u32()
    place = u32("in `powers`")


class Sums:
    """Sums of states kept in a format; `range` as `storage.Pack` finds it."""

    def __init__(self, gpu: Gpu, cells: int, format: Format, range: Buffer) -> None:
        self._cells, self._range = cells, range
        self._powers = Buffer(gpu, "power of the last blocks", 32)
        self._power = _power_pass(gpu, format)
        self._to_total = _accumulate_pass(gpu, format, FLOAT, is_scaled=format is not FLOAT)
        same = format is FLOAT
        self._to_state = self._to_total if same else _accumulate_pass(gpu, format, format)

    def add(self, commands: Commands, state: Buffer, other: Buffer) -> None:
        """other += state, both states."""
        self._accumulate(commands, self._to_state, state, other)

    def add_to_total(
        self, commands: Commands, state: Buffer, total: Buffer, *, is_tail: bool = False
    ) -> None:
        """total += state (float32, W sr^-1), or what all blocks after it would be.

        The ratio of the two powers that were measured says how blocks shrink.
        """
        self._accumulate(commands, self._to_total, state, total, is_tail=is_tail)

    def measure(self, commands: Commands, block: Buffer, place: int) -> None:
        """Remember the power of the last block but one (place 0) or of the last (1)."""
        self._power.dispatch(
            commands, (1,), params=PowerParams(cells=self._cells, place=place), state=block,
            powers=self._powers,
        )  # fmt: skip

    def _accumulate(
        self, commands: Commands, accumulate: ComputePass, state: Buffer, total: Buffer, *,
        is_tail: bool = False,
    ) -> None:  # fmt: skip
        values = 3 * self._cells
        accumulate.dispatch(
            commands, (values,), params=AccumulateParams(values=values, is_tail=int(is_tail)),
            state=state, powers=self._powers, range=self._range, total=total,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        self._powers.release()


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


def _accumulate_pass(
    gpu: Gpu, source: Format, target: Format, *, is_scaled: bool = False
) -> ComputePass:
    class Accumulate(ComputePass):
        slots = (
            uniform("params", AccumulateParams),
            storage("state", source.element),
            storage("powers", "vec4f"),
            storage("range", "f32"),
            storage("total", target.element, "read_write"),
        )
        workgroup = (256, 1, 1)
        file = "accumulate.wgsl"

    sum = "a + b" if target is FLOAT else "packed(unpacked(a) + b)"
    added = f"fn added(a: {target.element}, b: vec4f) -> {target.element} {{ return {sum}; }}\n"
    constants = {"IS_SCALED": float(is_scaled)}
    return Accumulate(gpu, constants=constants, generated=source.wgsl + added)
