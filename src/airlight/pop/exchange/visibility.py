"""Surfaces between media: the share of every block of the others that each cell sees past them.

Straight lines through the face visibility of the lattice, from four samples of a block. They depend
on surfaces and the positions of media only, and are recomputed where those changed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, u32
from ...gpu.memory import Buffer, buffer_of
from ...gpu.slots import storage, uniform
from ...lattice.blockers import BLOCKER_SLOTS, Blockers
from ...lattice.placement import LatticeParams
from ..light.table import OrdinateData
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams


class InterMediumParams(Struct):
    """How many blocks the others have."""

    blocks = u32()


class BlockVisibility(ComputePass):
    """Fills `seen`, f32 [block][cell], 0..1; 1 until `encode`."""

    slots = (
        uniform("params", MediumParams),
        uniform("exchange", InterMediumParams),
        uniform("lattice", LatticeParams),
        *BLOCKER_SLOTS,
        storage("ordinates", OrdinateData),
        storage("blocks", "vec4f"),
        storage("reach", "u32"),
        storage("seen", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)

    def __init__(self, receiver: GridMedium, blocks: int) -> None:
        super().__init__(receiver.gpu)
        self._receiver, self._blocks = receiver, blocks
        # Until surfaces are known everything is seen.
        ones = np.ones(receiver.cells * blocks, np.float32)
        self.seen = buffer_of(receiver.gpu, "seen of other media", ones)
        self._made: tuple[Any, ...] = ()

    def forget(self) -> None:
        """The medium, or one that it meets, moved or changed."""
        self._made = ()

    def encode(
        self,
        commands: Commands,
        blockers: Blockers,
        version: int,
        ordinates: Buffer,
        blocks: Buffer,
    ) -> None:
        """Fill `seen` after blocks were positioned; `version`: of the geometry of `blockers`."""
        made = (version, blockers.placement)
        if made == self._made:
            return
        self._made = made
        # From every cell to four samples of every block.
        medium = self._receiver
        self.dispatch(
            commands,
            (medium.cells, self._blocks),
            params=medium.params,
            exchange=InterMediumParams(blocks=self._blocks),
            lattice=blockers.placement.params(),
            **blockers.bound,
            ordinates=ordinates,
            blocks=blocks,
            reach=medium.density.reach,
            seen=self.seen,
        )
