"""The density that every ordinate's light has passed on reaching every cell.

One dispatch over cells and ordinates, a march each. Elek2014 section 4.1 sweeps a grid turned
along each ordinate; differs: see `maths.delta_beam`.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import sampler, storage, texture, uniform
from .density import Density
from .ordinates import OrdinateData
from .placement import MediumParams, MediumPlacement


class Paths(ComputePass):
    """Fills `passed`, f32 [2][ordinate][z][y][x].

    First m of density 1, see `maths.voxels.density_behind`; then the share of light that surfaces
    let through: 1, until `Visibility` says otherwise.
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

    def __init__(self, gpu: Gpu, placement: MediumPlacement, capacity: int) -> None:
        """For up to `capacity` ordinates."""
        super().__init__(gpu)
        self._cells = placement.cells
        self.passed = Buffer(gpu, "density passed", 8 * capacity * placement.cells)

    def encode(
        self, commands: Commands, params: MediumParams, ordinates: Buffer, count: int,
        density: Density,
    ) -> None:  # fmt: skip
        """March towards the first `count` ordinates."""
        self.dispatch(
            commands, (self._cells, max(1, count)), params=params, ordinates=ordinates,
            reach=density.reach, fine=density.fine, linear_clamp=density.linear, passed=self.passed,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        self.passed.release()
