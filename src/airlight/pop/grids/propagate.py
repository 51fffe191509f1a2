"""Steps of light through all grids at once (Elek2014 sections 4.1 to 4.3, 5.4, 6).

A chain of dispatches, each over all cells of all grids. See `maths.ordinate_hops`.
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..light.incident import IncidentLight
from ..light.table import OrdinateData
from ..medium.placement import MediumParams
from .grids import GROUP, GridData, GridParams, Grids, grid_capacity

_PARTS = 3  # vec4 per cell of a state (ahead, side, behind) and of what is gathered

# Of both passes: the medium, and the grids of its ordinates.
_common = (
    uniform("params", MediumParams),
    uniform("hops", GridParams),
    storage("grids", GridData),
    storage("solid_angles", "f32"),
    storage("hop_rho", "f32"),
)
_out = (
    storage("states_out", "vec4f", "read_write"),
    storage("gathered", "vec4f", "read_write"),
)


class _Begin(ComputePass):
    slots = (*_common, storage("ordinates", OrdinateData), storage("passed", "f32"), *_out)
    workgroup = (64, 1, 1)
    file = "begin.wgsl"


class _Step(ComputePass):
    slots = (*_common, storage("listed", "u32"), storage("states_in", "vec4f"), *_out)
    workgroup = (GROUP, 1, 1)
    file = "propagate.wgsl"


def chain_bytes(side: int, most: int) -> int:
    """The size of the largest buffer for `most` grids of about `side`^3 cells."""
    return 16 * _PARTS * grid_capacity(side) * most


class Propagate:
    """Fills `gathered`: vec4 [grid][cell][seen, residual, carried]; see `maths.Propagated`.

    In the w of `seen`: the share of light along the grid that surfaces let into the cell.
    """

    def __init__(self, gpu: Gpu, grids: Grids, most: int) -> None:
        """For `grids` that are at most `most`."""
        # Two states change roles from step to step; what the eye sees is summed beside them.
        nbytes = 16 * _PARTS * grids.capacity * most
        self._grids = grids
        self.gathered = Buffer(gpu, "light of grids", nbytes)
        self._states = [Buffer(gpu, f"states of grids {k}", nbytes) for k in (0, 1)]
        self._begin, self._step = _Begin(gpu), _Step(gpu)

    def encode_begin(
        self, commands: Commands, params: MediumParams, light: IncidentLight, eye: Any
    ) -> None:
        """Fill the first state: light that scatters once, column by column along each grid."""
        grids = self._grids
        # Cells that are not listed never send anything.
        commands.encoder.clear_buffer(self._states[1].handle)
        self._begin.dispatch(
            commands,
            (grids.columns, max(1, grids.count)),
            params=params,
            hops=grids.params(eye),
            **grids.bound,
            ordinates=light.table.rows,
            passed=light.passed,
            states_out=self._states[0],
            gathered=self.gathered,
        )

    def encode(self, commands: Commands, params: MediumParams, eye: Any, iterations: int) -> None:
        """Propagate for so many `iterations`, from one state to the other in turn."""
        grids = self._grids
        # In the last step all light that still propagates joins the residuum.
        going, last = grids.params(eye), grids.params(eye, is_last=True)
        for k in range(iterations):
            self._step.dispatch_indirect(
                commands,
                grids.groups,
                params=params,
                hops=last if k == iterations - 1 else going,
                **grids.bound,
                listed=grids.listed,
                states_in=self._states[k % 2],
                states_out=self._states[1 - k % 2],
                gathered=self.gathered,
            )
