"""Light that the other media scatter towards one, from outside its box.

Each other medium is cut into blocks. What a block scatters out of beams, and of its diffuse light,
is a source with its net direction, seen from every cell through what lies between as one more
ordinate: a scaled beam, as all others. Walls stop it; see `given_sight`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, u32
from ...gpu.memory import Buffer
from ...gpu.slots import sampler, storage, uniform
from ..light.ordinates import OrdinateData, OrdinateTable
from ..medium.grid_medium import GridMedium
from ..medium.mixture import BLOCKS, PER_AXIS, Mix, MixedData, fine_bound, fine_slots, fine_wgsl
from ..medium.placement import MediumParams
from .visibility import GivenSight

if TYPE_CHECKING:
    from ..light.visibility import Surfaces


class BlockParams(Struct):
    """The one that takes a medium's light."""

    taker_from_giver = mat4x4f("m to m")
    uvw_from_giver = mat4x4f("m to 0..1 in the taker's box")
    first_row = u32("of the taker's ordinates")
    first = u32("of the taker's blocks")
    scale = f32("the taker's units per the giver's; 0: dark")


class GivenParams(Struct):
    """How many blocks there are."""

    blocks = u32()


class _Blocks(ComputePass):
    workgroup = (BLOCKS, 1, 1)
    file = "blocks.wgsl"

    def __init__(self, gpu: Gpu, mix: Mix) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", MediumParams),
            uniform("block", BlockParams),
            *mix.cell_slots,
            storage("density", "f32"),
            storage("deposits", "vec4f"),
            storage("diffuse", "vec4f"),
            storage("ordinates", OrdinateData, "read_write"),
            storage("blocks", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=f"const PER_AXIS = {PER_AXIS}u;\n{mix.cell_wgsl}")


class _Given(ComputePass):
    workgroup = (64, 1, 1)
    file = "irradiance.wgsl"

    def __init__(self, gpu: Gpu, others: int) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", MediumParams),
            uniform("way", GivenParams),
            storage("media", MixedData),
            storage("ordinates", OrdinateData),
            storage("blocks", "vec4f"),
            storage("reach", "u32"),
            storage("seen", "f32"),
            sampler("linear_clamp"),
            *fine_slots(others),
            storage("given", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=fine_wgsl(others))


class Given:
    """Fills a medium's `Mix.given` and places its last ordinates."""

    def __init__(self, gpu: Gpu, mix: Mix) -> None:
        self._blocks = Buffer(gpu, "blocks of other media", 16 * 5 * mix.blocks)
        self._gather, self._give = _Blocks(gpu, mix), _Given(gpu, mix.media - 1)
        self._sight = GivenSight(gpu, mix.cells, mix.blocks)

    def encode(
        self,
        commands: Commands,
        taker: GridMedium,
        table: OrdinateTable,
        surfaces: Surfaces | None,
        *,
        is_lit: bool,
    ) -> None:
        """What the taker's others send now, as the last of `table`. Not `is_lit`: places alone.

        `surfaces`: what stands between them.
        """
        for index in range(len(taker.others)):
            self._gather_block(commands, taker, table, index, is_lit=is_lit)
        placement, params = taker.placement, taker.params
        if surfaces is not None and surfaces.blockers is not None and not is_lit:
            self._sight.encode(
                commands,
                params,
                placement,
                surfaces.blockers,
                version=surfaces.meshes.version,
                ordinates=table.rows,
                blocks=self._blocks,
                reach=taker.density.reach,
            )
        self._give.dispatch(
            commands,
            (placement.cells, taker.mix.blocks),
            params=params,
            way=GivenParams(blocks=taker.mix.blocks),
            media=taker.mix.rows,
            ordinates=table.rows,
            blocks=self._blocks,
            reach=taker.density.reach,
            seen=self._sight.seen,
            linear_clamp=taker.density.linear,
            **fine_bound(taker.fine_others),
            given=taker.mix.given,
        )

    def _gather_block(
        self,
        commands: Commands,
        taker: GridMedium,
        table: OrdinateTable,
        index: int,
        *,
        is_lit: bool,
    ) -> None:
        """The blocks of one of the others."""
        giver = taker.others[index]
        to_world = giver.placement.world_from_medium
        block = BlockParams(
            taker_from_giver=np.linalg.inv(taker.placement.world_from_medium) @ to_world,
            uvw_from_giver=taker.placement.uvw_from_world @ to_world,
            first_row=table.count - taker.mix.blocks + BLOCKS * index,
            first=BLOCKS * index,
            scale=giver.sent.scale / table.scale if is_lit else 0.0,
        )
        self._gather.dispatch(
            commands,
            (BLOCKS,),
            params=giver.params,
            block=block,
            **giver.mix.cell_bound,
            density=giver.density.cells,
            deposits=giver.sent.deposits,
            diffuse=giver.sent.diffuse,
            ordinates=table.rows,
            blocks=self._blocks,
        )

    def forget(self) -> None:
        """Media moved, or changed."""
        self._sight.forget()
