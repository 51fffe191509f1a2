"""Visibility of all 26 hops of every cell, packed once for as long as the geometry stands.

maths.lattice26_walls.open_hops is the NumPy twin.
differs: Billeter2012 section 4.2 renders six shadow maps for it in every frame.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..lattice.placement import LatticeSize

PACKS = 4
"""vec4u per cell. Two hold the open shares of the hops that neighbours send it, a byte each, by the
number of the hop to the neighbour (wgsl/hops26); two those of its own hops. The last word of the
fourth is the walls' reflectance, rgb unorm8."""


class _Leaving(ComputePass):
    slots = (
        uniform("params", LatticeSize),
        storage("face_visibility", "vec2u"),
        storage("reflectance", "u32"),
        storage("packs", "vec4u", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "hops_leaving.wgsl"


class _Entering(ComputePass):
    slots = (
        uniform("params", LatticeSize),
        storage("packs", "vec4u", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "hops_entering.wgsl"


class CellReflectance(ComputePass):
    """Mean colour of the walls in and around each cell, rgb unorm8 in a u32."""

    slots = (
        uniform("params", LatticeSize),
        storage("faces", "vec4u"),
        storage("reflectance", "u32", "read_write"),
    )
    workgroup = (32, 8, 1)
    file = "cell_reflectance.wgsl"

    def encode(
        self, commands: Commands, count: tuple[int, int, int], faces: Buffer, reflectance: Buffer
    ) -> None:
        """`faces` as lattice.blockers.Blockers.faces."""
        self.dispatch(
            commands,
            count,
            params=LatticeSize(count=count),
            faces=faces,
            reflectance=reflectance,
        )


class HopVisibility:
    """Makes `packs` (4 vec4u per cell) of a lattice from the visibility through its faces."""

    def __init__(self, gpu: Gpu) -> None:
        self._leaving = _Leaving(gpu)
        self._entering = _Entering(gpu)

    def encode(
        self,
        commands: Commands,
        count: tuple[int, int, int],
        face_visibility: Buffer,
        reflectance: Buffer,
        packs: Buffer,
    ) -> None:
        """`face_visibility` as lattice.blockers; `reflectance` one u32 (rgb unorm8) per cell."""
        # The hops that each cell sends; from them, those that its neighbours send it.
        params = LatticeSize(count=count)
        self._leaving.dispatch(
            commands,
            count,
            params=params,
            face_visibility=face_visibility,
            reflectance=reflectance,
            packs=packs,
        )
        self._entering.dispatch(commands, count, params=params, packs=packs)


def new_packs(gpu: Gpu, cells: int) -> Buffer:
    """Memory for `HopVisibility.encode`."""
    return Buffer(gpu, "visibility of 26 hops", cells * PACKS * 16)
