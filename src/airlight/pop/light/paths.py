"""The density that every ordinate's light has passed on reaching every cell.

One dispatch over cells and ordinates, a march each. Elek2014 section 4.1 sweeps a grid turned
along each ordinate; differs: see `maths.delta_beam`.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32
from ...gpu.memory import Buffer, Texture
from ...gpu.slots import sampler, storage, texture, uniform
from ..medium.density import Density
from ..medium.mixture import Mix, fine_bound, fine_slots, fine_wgsl
from ..medium.placement import MediumParams, MediumPlacement
from .ordinates import OrdinateData


class WayParams(Struct):
    """How far other media count."""

    is_closed = u32("1: in the medium's own box alone")


class _Others(ComputePass):
    workgroup = (64, 1, 1)
    file = "paths_others.wgsl"

    def __init__(self, gpu: Gpu, mix: Mix) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", MediumParams),
            uniform("ways", WayParams),
            storage("ordinates", OrdinateData),
            *mix.cell_slots,
            storage("reach", "u32"),
            *fine_slots(mix.media - 1),
            sampler("linear_clamp"),
            storage("passed", "f32", "read_write"),
        )
        super().__init__(gpu, generated=fine_wgsl(mix.media - 1))


class Paths(ComputePass):
    """Fills `passed`, f32 [2 * media][ordinate][z][y][x].

    First m of density 1, see `maths.voxels.density_behind`; then the share of light that surfaces
    let through: 1, until `Visibility` says otherwise; then the others'
    m of density 1, in the medium's box and beyond it.
    """

    slots = (
        uniform("params", MediumParams),
        storage("ordinates", OrdinateData),
        storage("reach", "u32"),
        texture("fine", "3d"),
        sampler("linear_clamp"),
        storage("passed", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)

    def __init__(self, gpu: Gpu, placement: MediumPlacement, capacity: int, mix: Mix) -> None:
        """For up to `capacity` ordinates."""
        super().__init__(gpu)
        self._cells, self._mix = placement.cells, mix
        self._others = None if mix.is_alone else _Others(gpu, mix)
        self.passed = Buffer(gpu, "density passed", 8 * mix.media * capacity * placement.cells)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        ordinates: Buffer,
        count: int,
        density: Density,
        others: Sequence[Texture] = (),
        *,
        is_closed: bool = False,
    ) -> None:
        """March towards the first `count` ordinates; past `others` (their `Density.fine`)."""
        self.dispatch(
            commands,
            (self._cells, max(1, count)),
            params=params,
            ordinates=ordinates,
            reach=density.reach,
            fine=density.fine,
            linear_clamp=density.linear,
            passed=self.passed,
        )
        if self._others is not None:
            self._others.dispatch(
                commands,
                (self._cells, max(1, count)),
                params=params,
                ways=WayParams(is_closed=int(is_closed)),
                ordinates=ordinates,
                **self._mix.cell_bound,
                reach=density.reach,
                **fine_bound(others),
                linear_clamp=density.linear,
                passed=self.passed,
            )
