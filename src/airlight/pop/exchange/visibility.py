"""Walls between media: how much of every block of the others each cell sees past surfaces.

Straight walks through the faces that blockers leave open, from four places of a block. They depend
on surfaces and on where media are alone, and are taken anew where those changed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, mat4x4f, u32
from ...gpu.memory import Buffer, buffer_of
from ...gpu.slots import storage, texture, uniform
from ...lattice.blockers import Blockers
from ...lattice.placement import LatticeParams
from ..light.ordinates import OrdinateData
from ..medium.placement import MediumParams, MediumPlacement


class WallParams(Struct):
    """Where the medium is, and how many blocks there are."""

    world_from_medium = mat4x4f()
    blocks = u32()


class GivenSight(ComputePass):
    """Fills `seen`, f32 [block][cell], 0..1: 1 while nothing stands anywhere."""

    slots = (
        uniform("params", MediumParams),
        uniform("walls", WallParams),
        uniform("lattice", LatticeParams),
        *(texture(f"lattice_{name}", "3d") for name in ("visibility_a", "visibility_b", "walls")),
        storage("ordinates", OrdinateData),
        storage("blocks", "vec4f"),
        storage("reach", "u32"),
        storage("seen", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "visibility.wgsl"

    def __init__(self, gpu: Gpu, cells: int, blocks: int) -> None:
        super().__init__(gpu)
        self._blocks = blocks
        self.seen = buffer_of(gpu, "seen of other media", np.ones(cells * blocks, np.float32))
        self._made: tuple[Any, ...] = ()

    def forget(self) -> None:
        """Media moved, or changed."""
        self._made = ()

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        placement: MediumPlacement,
        blockers: Blockers,
        *,
        version: int,
        ordinates: Buffer,
        blocks: Buffer,
        reach: Buffer,
    ) -> None:
        """After blocks were placed; `version`: of the geometry that `blockers` are of."""
        made = (version, blockers.placement)
        if made == self._made:
            return
        self._made = made
        walls = WallParams(world_from_medium=placement.world_from_medium, blocks=self._blocks)
        self.dispatch(
            commands,
            (placement.cells, self._blocks),
            params=params,
            walls=walls,
            lattice=blockers.placement.params(),
            **blockers.bound,
            ordinates=ordinates,
            blocks=blocks,
            reach=reach,
            seen=self.seen,
        )
