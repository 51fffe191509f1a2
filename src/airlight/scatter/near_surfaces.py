"""The cells of a lattice that surfaces read: light that nothing else reads is needed there alone.

A surface reads the eight cells around the point half a cell before it, so a cell is read where a
surfel lies about a corner of its own or of a neighbour's.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.lattices import Level
from ..lattice.placement import LatticeSize


class _Near(ComputePass):
    slots = (
        uniform("params", LatticeSize),
        storage("sums", "i32"),
        storage("near", "u32", "read_write"),
    )
    workgroup = (32, 4, 2)
    file = "near_surfaces.wgsl"


class NearSurfaces:
    """`cells`: 1 for each cell that surfaces read, else 0."""

    def __init__(self, gpu: Gpu, level: Level) -> None:
        self._level, self._pass = level, _Near(gpu)
        self.cells = Buffer(gpu, "cells near surfaces", 4 * level.placement.cells)
        self._version = -1

    def encode(self, commands: Commands) -> None:
        """Find them, where the blockers changed."""
        blockers, count = self._level.blockers, self._level.placement.count
        # Where surfaces are depends on the walls alone.
        if blockers.version != self._version:
            self._version = blockers.version
            self._pass.dispatch(
                commands,
                count,
                params=LatticeSize(count=count),
                sums=blockers.sums,
                near=self.cells,
            )
