"""Light hopping through all ordinates' grids at once (Elek2014 sections 4.1 to 4.3, 5.4, 6).

A chain of dispatches, each over all cells of all grids. See `maths.ordinate_hops`.
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..light.ordinates import OrdinateData
from ..medium.placement import MediumParams
from .grids import GROUP, HopGridData, HopGrids, HopParams, hop_capacity

_PARTS = 3  # vec4 per cell of a state (ahead, side, behind) and of what is gathered

_common = (
    uniform("params", MediumParams),
    uniform("hops", HopParams),
    storage("grids", HopGridData),
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


class _Hop(ComputePass):
    slots = (*_common, storage("listed", "u32"), storage("states_in", "vec4f"), *_out)
    workgroup = (GROUP, 1, 1)
    file = "propagate.wgsl"


def chain_bytes(side: int, most: int) -> int:
    """Of the largest buffer for `most` grids of about `side`^3 cells."""
    return 16 * _PARTS * hop_capacity(side) * most


class Propagate:
    """Fills `gathered`: vec4 [grid][cell][seen, residual, carried]; see `maths.Propagated`.

    In the first one's w: the share of light along the grid that surfaces let into the cell.
    """

    def __init__(self, gpu: Gpu, capacity: int, most: int) -> None:
        """For at most `most` grids of `capacity` cells."""
        nbytes = 16 * _PARTS * capacity * most
        self.gathered = Buffer(gpu, "light of hop grids", nbytes)
        self._states = [Buffer(gpu, f"hop states {k}", nbytes) for k in (0, 1)]
        self._begin, self._hop = _Begin(gpu), _Hop(gpu)

    def encode_begin(
        self,
        commands: Commands,
        params: MediumParams,
        grids: HopGrids,
        ordinates: Buffer,
        passed: Buffer,
        eye: Any,
        *,
        is_paper: bool,
    ) -> None:
        """Put the light in; `passed` as `Paths` and `Visibility` leave it."""
        # Cells that are not listed send nothing, ever.
        commands.encoder.clear_buffer(self._states[1].handle)
        self._begin.dispatch(
            commands,
            (grids.columns, max(1, grids.count)),
            params=params,
            hops=grids.params(eye, is_paper=is_paper),
            **_bound(grids),
            ordinates=ordinates,
            passed=passed,
            states_out=self._states[0],
            gathered=self.gathered,
        )

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        grids: HopGrids,
        eye: Any,
        iterations: int,
        *,
        is_paper: bool,
    ) -> None:
        """Hop `iterations` times."""
        going = grids.params(eye, is_paper=is_paper)
        last = grids.params(eye, is_paper=is_paper, is_last=True)
        for k in range(iterations):
            self._hop.dispatch_indirect(
                commands,
                grids.groups,
                params=params,
                hops=last if k == iterations - 1 else going,
                **_bound(grids),
                listed=grids.listed,
                states_in=self._states[k % 2],
                states_out=self._states[1 - k % 2],
                gathered=self.gathered,
            )


def _bound(grids: HopGrids) -> dict[str, Buffer]:
    return {
        "grids": grids.rows,
        "solid_angles": grids.solid_angles,
        "hop_rho": grids.density,
    }
