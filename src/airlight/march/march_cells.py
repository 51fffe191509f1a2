"""What marching asks the cells of a lattice, packed: a read for each place, not six.

Software drivers pay for reads, whatever they bring; the three textures that say how open cells
are and where their walls lie hold eight bits each.
"""

from __future__ import annotations

from typing import Any, ClassVar

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import Slot, storage, texture
from ..lattice.placement import LatticeParams

_NAMES = ("lattice_open_a", "lattice_open_b", "lattice_walls")
_CELL_BYTES = 16


class _Pack(ComputePass):
    slots: ClassVar[tuple[Slot, ...]] = (
        storage("lattices", LatticeParams), *(texture(name, "3d") for name in _NAMES),
        storage("march_cells", "vec4u", "read_write"),
    )  # fmt: skip
    workgroup = (32, 4, 1)
    file = "march_cells.wgsl"


class MarchCells:
    """A buffer of vec4u per cell: open shares (xy, z), walls' shifts on low and on high faces."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu, self._pass = gpu, _Pack(gpu)
        self.buffer: Buffer | None = None

    def encode(
        self, commands: Commands, count: tuple[int, int, int], values: dict[str, Any]
    ) -> Buffer:
        """Pack the last of the lattices in `values` (by slot name), of `count` cells."""
        nbytes = _CELL_BYTES * count[0] * count[1] * count[2]
        if self.buffer is None or self.buffer.nbytes != nbytes:
            self.release()
            self.buffer = Buffer(self._gpu, "cells to march", nbytes)
        bound = {name: values[name] for name in ("lattices", *_NAMES)}
        self._pass.dispatch(commands, count, **bound, march_cells=self.buffer)
        return self.buffer

    def release(self) -> None:
        """Give the memory back."""
        if self.buffer is not None:
            self.buffer.release()
