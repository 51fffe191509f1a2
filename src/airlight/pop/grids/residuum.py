"""The paper's own residuum: radiance that propagates isotropically (Elek2014 section 5.4)."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, f32, u32
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams


class ResiduumParams(Struct):
    """One step."""

    step = u32()
    scale = f32("m^-2: radiance per unit of what is read")


class _Step(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("residuum", ResiduumParams),
        storage("density", "f32"),
        storage("light_in", "vec4f"),
        storage("light_out", "vec4f", "read_write"),
        storage("diffuse", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "residuum.wgsl"


class Residuum:
    """Isotropic radiance on the cells of the medium."""

    def __init__(self, medium: GridMedium) -> None:
        self._medium = medium
        nbytes = 16 * medium.cells
        # Read and written in turn.
        self._states = [Buffer(medium.gpu, f"isotropic light {k}", nbytes) for k in (0, 1)]
        self._step = _Step(medium.gpu)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        deposits: Buffer,
        diffuse: Buffer,
        iterations: int,
    ) -> None:
        """Sum `iterations` steps of `deposits` (W per cell) into `diffuse`; 0: leave it dark."""
        medium = self._medium
        cell = medium.placement.cell
        section = float(cell.prod() / cell.mean())
        for step in range(max(1, iterations)):
            # The first step reads W per cell, the others radiance.
            scale = 1.0 / section if step == 0 else 1.0
            self._step.dispatch(
                commands,
                (medium.cells,),
                params=params,
                residuum=ResiduumParams(step=step, scale=scale if iterations else 0.0),
                density=medium.density.cells,
                light_in=self._states[step % 2] if step else deposits,
                light_out=self._states[1 - step % 2],
                diffuse=diffuse,
            )
