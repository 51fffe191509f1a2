"""Packed face visibility of a lattice: one load per lookup of marching instead of six.

CPU adapters pay for reads, whatever they bring; the three textures that say how open cells
are and where their walls lie hold eight bits each.
"""

from __future__ import annotations

from typing import Any, ClassVar

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.memory import Texture
from ...gpu.slots import Slot, image, storage, texture
from ...lattice.placement import LatticeParams

_NAMES = ("lattice_visibility_a", "lattice_visibility_b", "lattice_walls")


class _Pack(ComputePass):
    slots: ClassVar[tuple[Slot, ...]] = (
        storage("lattices", LatticeParams),
        *(texture(name, "3d") for name in _NAMES),
        image("march_cells", "rgba32uint", "3d"),
    )
    workgroup = (32, 4, 1)
    file = "cells.wgsl"


class MarchCells:
    """A texel per cell: open shares of low and of high faces, walls' shifts on both."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu, self._pass = gpu, _Pack(gpu)
        self.texture = self._made((1, 1, 1))

    def _made(self, count: tuple[int, int, int]) -> Texture:
        return Texture(
            self._gpu, "cells to march", count, "rgba32uint", dimension="3d", written=True
        )

    def encode(
        self, commands: Commands, count: tuple[int, int, int], values: dict[str, Any]
    ) -> Texture:
        """Pack the last of the lattices in `values` (by slot name), of `count` cells."""
        if self.texture.size != count:
            self.texture.release()
            self.texture = self._made(count)
        bound = {name: values[name] for name in ("lattices", *_NAMES)}
        self._pass.dispatch(commands, count, **bound, march_cells=self.texture)
        return self.texture
