"""A grid of shells around every virtual point light, placed on the device (Elek2014 section 6).

The device samples virtual point lights, so the host does not know where they are: one workgroup
writes a row of `GridData` for each, after those of ordinates and local lights. From then on it is a
grid like theirs.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, f32, u32
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..grids.grids import FAR, FIXED_POINT_BITS, GridData, GridParams, Grids
from ..light.table import OrdinateData
from ..medium.placement import MediumParams


class VirtualGridParams(Struct):
    """The shape of the grids of virtual point lights."""

    side = u32("cells along a shell's square")
    shells = u32()
    growth = f32("of shells")
    far = f32("half diagonals from the middle of the medium from which on grids are parallel")
    first = u32("grid of the first virtual point light")
    is_blurred = u32("1: a lobe is as wide as the piece of surface is seen")
    power = f32("W of local lights, in units of the table's scale")
    most = f32("integers that all residuum may be")


class VirtualGrids(ComputePass):
    """Writes the last rows of `Grids.rows`, and `fixed_scale` for all."""

    slots = (
        uniform("params", MediumParams),
        uniform("hops", GridParams),
        uniform("shape", VirtualGridParams),
        storage("ordinates", OrdinateData),
        storage("grids", GridData, "read_write"),
    )
    workgroup = (64, 1, 1)

    def encode(
        self, commands: Commands, params: MediumParams, grids: Grids, ordinates: Buffer
    ) -> None:
        """Place the grids, after `VirtualLights` wrote their rows of `ordinates`."""
        # Grids of virtual point lights follow those of the scene's own lights, which the host
        # placed.
        shape = VirtualGridParams(
            side=grids.side,
            shells=grids.shells,
            growth=grids.growth,
            far=FAR,
            first=grids.count - grids.virtual,
            is_blurred=int(grids.is_blurred),
            power=grids.local_power,
            most=float(2**FIXED_POINT_BITS),
        )
        self.dispatch(
            commands,
            (1,),
            params=params,
            hops=grids.params((0.0, 0.0, 0.0)),
            shape=shape,
            ordinates=ordinates,
            grids=grids.rows,
        )
