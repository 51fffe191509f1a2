"""What leaves all beams in every cell of the medium: power, and the net power it carries on."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .ordinates import OrdinateData
from .placement import MediumParams


class Deposit(ComputePass):
    """Fills `deposits`: vec4 [P, Bx, By, Bz][z][y][x], W, rgb; see `maths.delta_beam.deposit`."""

    slots = (
        uniform("params", MediumParams),
        storage("ordinates", OrdinateData),
        storage("passed", "f32"),
        storage("density", "f32"),
        storage("deposits", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)

    def encode(
        self, commands: Commands, params: MediumParams, cells: int, *, ordinates: Buffer,
        passed: Buffer, density: Buffer, deposits: Buffer,
    ) -> None:  # fmt: skip
        """Sum over all ordinates, cell by cell: no atomics, the same bits every time."""
        self.dispatch(
            commands, (cells,), params=params, ordinates=ordinates, passed=passed,
            density=density, deposits=deposits,
        )  # fmt: skip
