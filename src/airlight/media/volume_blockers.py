"""Air as blockers: what a lattice that knows surfaces only loses and turns back in volumes.

Light on a hop collides with the reduced extinction of both its cells. What is scattered leaves to
both sides alike, so half of it is turned back and half goes on; the rest is absorbed: two streams
(Schuster 1905, of light in fog), as shares that a face reflects and stops.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, u32
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeParams, Placement
from .gpu_media import GpuMedia

PLACES = 3
"""Samples of the density along each axis of a cell."""


class VolumeBlockerParams(Struct):
    """How finely air is looked at."""

    places = u32("along each axis of a cell")


class _Cells(ComputePass):
    workgroup = (8, 8, 4)
    file = "volume_blockers_cells.wgsl"

    def __init__(self, gpu: Gpu, air: GpuMedia) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", VolumeBlockerParams),
            uniform("lattice", LatticeParams),
            storage("cells", "vec4f", "read_write"),
            *air.medium_slots,
        )
        super().__init__(gpu, generated=air.medium_wgsl)


class _Faces(ComputePass):
    slots = (
        uniform("lattice", LatticeParams),
        storage("cells", "vec4f"),
        storage("walls", "vec4u"),
        storage("faces", "vec4u", "read_write"),
    )
    workgroup = (8, 8, 4)
    file = "volume_blockers.wgsl"


class VolumeBlockers:
    """`faces`: those of `lattice.blockers.Blockers`, and the air between."""

    def __init__(self, gpu: Gpu, air: GpuMedia, cells: int) -> None:
        self._air = air
        self._cells = Buffer(gpu, "air in cells", 16 * cells)
        self.faces = Buffer(gpu, "cell faces in air", 32 * cells)
        self._look, self._combine = _Cells(gpu, air), _Faces(gpu)

    def encode(self, commands: Commands, placement: Placement, walls: Buffer) -> None:
        """Make `faces` of the blockers' `walls` and the air as it is."""
        lattice = placement.params()
        self._look.dispatch(
            commands,
            placement.count,
            params=VolumeBlockerParams(places=PLACES),
            lattice=lattice,
            cells=self._cells,
            **self._air.medium_bound,
        )
        self._combine.dispatch(
            commands,
            placement.count,
            lattice=lattice,
            cells=self._cells,
            walls=walls,
            faces=self.faces,
        )
