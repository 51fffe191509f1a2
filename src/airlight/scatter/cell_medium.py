"""The air's coefficients averaged over cells, for propagation through varying air."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeParams, Placement
from ..media.gpu_media import GpuMedia


class AirCellParams(Struct):
    """How finely a cell is sampled."""

    places = u32("per axis")


class CellMedium(ComputePass):
    """(sigma_s, sigma_t), m^-1, per channel and cell: the mean over places^3 points."""

    workgroup = (32, 4, 2)

    def __init__(self, gpu: Gpu, air: GpuMedia) -> None:
        self._air = air
        self.slots = (  # type: ignore[misc]
            uniform("params", AirCellParams),
            uniform("lattice", LatticeParams),
            *air.medium_slots,
            storage("medium", "vec2f", "read_write"),
        )
        super().__init__(gpu, generated=air.medium_wgsl)

    def encode(self, commands: Commands, placement: Placement, medium: Buffer, places: int) -> None:
        """Fill `medium`, laid out [channel][z][y][x]."""
        self.dispatch(
            commands,
            placement.count,
            params=AirCellParams(places=places),
            lattice=placement.params(),
            medium=medium,
            **self._air.medium_bound,
        )
