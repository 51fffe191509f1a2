"""Coefficients of the media averaged over cells, for propagation where they vary."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeParams, Placement
from ..media.gpu_media import GpuMedia


class CellMediumParams(Struct):
    """How finely a cell is sampled."""

    samples = u32("per axis")


class CellMedium(ComputePass):
    """(sigma_s, sigma_t), m^-1, per channel and cell: the mean over samples^3 points."""

    workgroup = (32, 4, 2)

    def __init__(self, gpu: Gpu, media: GpuMedia) -> None:
        self._media = media
        self.slots = (
            uniform("params", CellMediumParams),
            uniform("lattice", LatticeParams),
            *media.medium_slots,
            storage("medium", "vec2f", "read_write"),
        )
        super().__init__(gpu, generated=media.medium_wgsl)

    def encode(
        self, commands: Commands, placement: Placement, medium: Buffer, samples: int
    ) -> None:
        """Fill `medium`, laid out [channel][z][y][x]."""
        self.dispatch(
            commands,
            placement.count,
            params=CellMediumParams(samples=samples),
            lattice=placement.params(),
            medium=medium,
            **self._media.medium_bound,
        )
