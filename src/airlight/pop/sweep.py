"""The optical path behind every cell of every ordinate's grid: one sweep along each ordinate.

All ordinates in one dispatch, an invocation per column (Elek2014 section 4.1).
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import sampler, storage, texture, uniform
from .density import Density
from .ordinates import OrdinateData
from .placement import MediumParams


class Sweep(ComputePass):
    """Fills `passed`: density passed, m, f32 [ordinate][face along the light][v][u]."""

    slots = (
        uniform("params", MediumParams),
        storage("ordinates", OrdinateData),
        texture("fine", "3d"),
        sampler("linear_clamp"),
        storage("passed", "f32", "read_write"),
    )
    workgroup = (8, 8, 1)

    def __init__(self, gpu: Gpu, capacity: int, side: int) -> None:
        """For up to `capacity` ordinates in grids of side^3 cells."""
        super().__init__(gpu)
        self._side = side
        self.passed = Buffer(gpu, "density passed", 4 * capacity * (side + 1) * side * side)

    def encode(
        self, commands: Commands, params: MediumParams, ordinates: Buffer, count: int,
        density: Density,
    ) -> None:  # fmt: skip
        """Sweep the first `count` ordinates."""
        self.dispatch(
            commands, (self._side, self._side, count), params=params, ordinates=ordinates,
            fine=density.fine, linear_clamp=density.linear, passed=self.passed,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        self.passed.release()
