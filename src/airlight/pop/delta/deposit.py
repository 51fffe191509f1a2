"""The power that leaves all beams in every cell, and the net power that it carries on."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..light.incident import IncidentLight
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams


class Deposit(ComputePass):
    """Fills `deposits`: vec4 [P, Bx, By, Bz][z][y][x], W, rgb; see `maths.delta_beam.deposit`."""

    workgroup = (64, 1, 1)

    def __init__(self, medium: GridMedium, light: IncidentLight) -> None:
        mixture = light.mixture
        self._medium, self._light = medium, light
        self.slots = (
            uniform("params", MediumParams),
            *light.slots,
            storage("density", "f32"),
            storage("deposits", "vec4f", "read_write"),
        )
        # Beams of all media, and what of them stays in the medium's own cells.
        beams = mixture.beam_wgsl(has_blocks=bool(light.blocks))
        super().__init__(medium.gpu, generated=beams + mixture.cell_wgsl_after_beams)

    def encode(self, commands: Commands, params: MediumParams, deposits: Buffer) -> None:
        """Sum over all ordinates, cell by cell: without atomics, so the bits are reproducible."""
        light = self._light
        # What lies between a cell and each light was summed up before, in `light.passed`.
        self.dispatch(
            commands,
            (self._medium.cells,),
            params=params,
            density=self._medium.density.cells,
            deposits=deposits,
            **light.bound,
        )
