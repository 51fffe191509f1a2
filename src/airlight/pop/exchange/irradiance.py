"""Inter-medium irradiance: light that the other media scatter towards one, from outside its box.

Each other medium is cut into blocks. The light that a block scatters out of beams, and of its
diffuse light, is a source with a net direction. It is one more ordinate of the receiving medium,
attenuated like all others; surfaces between shade it (`visibility`).
"""

from __future__ import annotations

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, u32
from ...gpu.memory import Buffer
from ...gpu.rows import table
from ...gpu.slots import sampler, storage, uniform
from ..light.table import OrdinateData, OrdinateTable
from ..light.visibility import Surfaces
from ..medium.grid_medium import GridMedium
from ..medium.mixture import (
    BLOCKS,
    BLOCKS_PER_AXIS,
    MixedData,
    Mixture,
    fine_bound,
    fine_slots,
    fine_wgsl,
)
from ..medium.placement import MediumParams
from .visibility import BlockVisibility, InterMediumParams


class BlockParams(Struct):
    """The medium that receives the light of another one."""

    receiver_from_sender = mat4x4f("m to m")
    uvw_from_sender = mat4x4f("m to 0..1 in the receiver's box")
    first_row = u32("of the receiver's ordinates")
    first = u32("of the receiver's blocks")
    scale = f32("the receiver's units per the sender's; 0: dark")


class _Blocks(ComputePass):
    workgroup = (BLOCKS, 1, 1)
    file = "blocks.wgsl"

    def __init__(self, gpu: Gpu, mixture: Mixture) -> None:
        self.slots = (
            uniform("params", MediumParams),
            uniform("receiver", BlockParams),
            *mixture.cell_slots,
            storage("density", "f32"),
            storage("deposits", "vec4f"),
            storage("diffuse", "vec4f"),
            storage("ordinates", OrdinateData, "read_write"),
            storage("blocks", "vec4f", "read_write"),
        )
        constant = f"const BLOCKS_PER_AXIS = {BLOCKS_PER_AXIS}u;\n"
        super().__init__(gpu, generated=constant + mixture.cell_wgsl)


class _Irradiance(ComputePass):
    workgroup = (64, 1, 1)
    file = "irradiance.wgsl"

    def __init__(self, gpu: Gpu, others: int) -> None:
        self.slots = (
            uniform("params", MediumParams),
            uniform("exchange", InterMediumParams),
            table("media", MixedData),
            storage("ordinates", OrdinateData),
            storage("blocks", "vec4f"),
            storage("reach", "u32"),
            storage("seen", "f32"),
            sampler("linear_clamp"),
            *fine_slots(others),
            storage("inter_medium", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=fine_wgsl(others))


class InterMediumLight:
    """Fills `Mixture.inter_medium` of the receiving medium, and positions its last ordinates."""

    def __init__(self, receiver: GridMedium, mixture: Mixture) -> None:
        gpu = receiver.gpu
        self._receiver = receiver
        # Five vec4 per block: power, net flux along x, y and z, optical depth.
        self._blocks = Buffer(gpu, "blocks of other media", 16 * 5 * mixture.blocks)
        self._gather = _Blocks(gpu, mixture)
        self._irradiance = _Irradiance(gpu, mixture.media - 1)
        self._visibility = BlockVisibility(receiver, mixture.blocks)

    def forget(self) -> None:
        """The medium, or one that it meets, moved or changed."""
        self._visibility.forget()

    def encode(
        self, commands: Commands, table: OrdinateTable, surfaces: Surfaces | None, *, is_lit: bool
    ) -> None:
        """Receive what the other media scatter as they are solved, as the last of `table`.

        Not `is_lit`: only the positions of the blocks are set, from which visibility follows.
        """
        # The power of every block, and where it is.
        for index in range(len(self._receiver.others)):
            self._gather_blocks(commands, table, index, is_lit=is_lit)
        # Surfaces between the blocks and the cells, once they are positioned.
        if surfaces is not None and not is_lit:
            self._visibility.encode(
                commands, surfaces.blockers, surfaces.meshes.version, table.rows, self._blocks
            )
        # The irradiance of each block in each cell.
        medium = self._receiver
        mixture, density = medium.mixture, medium.density
        self._irradiance.dispatch(
            commands,
            (medium.cells, mixture.blocks),
            params=medium.params,
            exchange=InterMediumParams(blocks=mixture.blocks),
            media=mixture.rows,
            ordinates=table.rows,
            blocks=self._blocks,
            reach=density.reach,
            seen=self._visibility.seen,
            linear_clamp=density.linear,
            **fine_bound(medium.fine_others),
            inter_medium=mixture.inter_medium,
        )

    def _gather_blocks(
        self, commands: Commands, table: OrdinateTable, index: int, *, is_lit: bool
    ) -> None:
        """Sum up the blocks of one of the other media."""
        receiver, sender = self._receiver, self._receiver.others[index]
        # From the cells of the sender to the frame of the receiver.
        to_world = sender.placement.world_from_medium
        params = BlockParams(
            receiver_from_sender=np.linalg.inv(receiver.placement.world_from_medium) @ to_world,
            uvw_from_sender=receiver.placement.uvw_from_world @ to_world,
            first_row=table.count - receiver.mixture.blocks + BLOCKS * index,
            first=BLOCKS * index,
            # In the unit of the receiver's table; 0 while the sender has no light.
            scale=sender.scattered.scale / table.scale if is_lit else 0.0,
        )
        self._gather.dispatch(
            commands,
            (BLOCKS,),
            params=sender.params,
            receiver=params,
            **sender.mixture.cell_bound,
            density=sender.density.cells,
            deposits=sender.scattered.deposits,
            diffuse=sender.scattered.diffuse,
            ordinates=table.rows,
            blocks=self._blocks,
        )
