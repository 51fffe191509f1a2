"""One lattice less another: steps are linear, so light can be told apart by what it left out."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform


class LessParams(Struct):
    """The lattices' size."""

    values = u32("vec4 values in each")


class Less(ComputePass):
    """rest = whole - part, lattices of vec4f."""

    slots = (
        uniform("params", LessParams),
        storage("whole", "vec4f"),
        storage("part", "vec4f"),
        storage("rest", "vec4f", "read_write"),
    )
    workgroup = (256, 1, 1)

    def encode(self, commands: Commands, whole: Buffer, part: Buffer, rest: Buffer) -> None:
        """Fill `rest`, as long as both others."""
        values = rest.nbytes // 16
        self.dispatch(
            commands,
            (values,),
            params=LessParams.of(values=values),
            whole=whole,
            part=part,
            rest=rest,
        )
