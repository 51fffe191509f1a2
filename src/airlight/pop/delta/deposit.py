"""What leaves all beams in every cell of the medium: power, and the net power it carries on."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..light.ordinates import OrdinateData
from ..medium.mixture import Mix
from ..medium.placement import MediumParams


class Deposit(ComputePass):
    """Fills `deposits`: vec4 [P, Bx, By, Bz][z][y][x], W, rgb; see `maths.delta_beam.deposit`."""

    workgroup = (64, 1, 1)

    def __init__(self, gpu: Gpu, mix: Mix, *, has_blocks: bool) -> None:
        """`has_blocks`: whether the last ordinates are other media's light."""
        self._mix = mix
        self.slots = (  # type: ignore[misc]
            uniform("params", MediumParams),
            storage("ordinates", OrdinateData),
            *mix.beam_slots,
            storage("passed", "f32"),
            storage("density", "f32"),
            storage("deposits", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=mix.beam_wgsl(has_blocks=has_blocks) + mix.cell_wgsl_more)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        cells: int,
        *,
        ordinates: Buffer,
        passed: Buffer,
        density: Buffer,
        deposits: Buffer,
    ) -> None:
        """Sum over all ordinates, cell by cell: no atomics, the same bits every time."""
        self.dispatch(
            commands,
            (cells,),
            params=params,
            ordinates=ordinates,
            passed=passed,
            density=density,
            deposits=deposits,
            **self._mix.beam_bound,
        )
