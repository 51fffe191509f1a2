"""A grid of shells around every virtual light, placed on the device (Elek2014 section 6).

Virtual lights are chosen there, so nobody else knows where they are: one workgroup writes a row of
`HopGridData` for each, after those of ordinates and lamps. From then on it is a grid like theirs.
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, f32, u32
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..grids.grids import FAR, FIXED_POINT_BITS, HopGridData, HopGrids, HopParams
from ..light.ordinates import OrdinateData
from ..medium.placement import MediumParams


class PlaceParams(Struct):
    """What a grid of virtual lights is like."""

    side = u32("cells along a shell's square")
    shells = u32()
    growth = f32("of shells")
    far = f32("half diagonals from the middle of the medium from which on grids are parallel")
    first = u32("grid of the first virtual light")
    is_blurred = u32("1: a lobe is as wide as the piece of surface is seen")
    power = f32("W of lamps, in units of the table's scale")
    most = f32("integers that all residuum may be")


class VirtualGrids(ComputePass):
    """Writes the last rows of `HopGrids.rows`, and `fixed_scale` for all."""

    slots = (
        uniform("params", MediumParams),
        uniform("hops", HopParams),
        uniform("place", PlaceParams),
        storage("ordinates", OrdinateData),
        storage("grids", HopGridData, "read_write"),
    )
    workgroup = (64, 1, 1)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        hops: HopParams,
        grids: HopGrids,
        ordinates: Buffer,
        *,
        prefilter: bool,
    ) -> None:
        """After `VirtualLights` wrote the rows of `ordinates`."""
        place = PlaceParams(
            side=grids.side,
            shells=grids.shells,
            growth=grids.growth,
            far=FAR,
            first=grids.count - grids.virtual,
            is_blurred=int(prefilter),
            power=grids.lamp_power,
            most=float(2**FIXED_POINT_BITS),
        )
        self.dispatch(
            commands,
            (1,),
            params=params,
            hops=hops,
            place=place,
            ordinates=ordinates,
            grids=grids.rows,
        )


def is_hopping(settings: Any, *, alone: bool) -> bool:
    """Whether virtual lights hop in grids of their own instead of being beams.

    `settings`: `PopSettings`; `alone`: whether a scene has no other medium, which hops know not of.
    """
    return settings.scheme != "delta-beam" or (settings.virtual_grids == "radial" and alone)
