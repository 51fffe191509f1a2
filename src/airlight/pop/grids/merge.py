"""The light of all grids on the medium's own cells (Elek2014 section 5.3), and the residuum.

Parallel grids are read trilinearly, weighted by density. The residuum around local lights, whose
cells are smaller than the medium's where it matters, is summed in fixed point: the bits are
reproducible.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams
from .grids import GridData, GridParams, Grids

# Of both passes: shells are added to cells by atomics, parallel grids are read.
_grids = (
    uniform("params", MediumParams),
    uniform("hops", GridParams),
    storage("grids", GridData),
    storage("solid_angles", "f32"),
    storage("gathered", "vec4f"),
    storage("splatted", "atomic<i32>", "read_write"),
    storage("hop_rho", "f32"),
)


class _Splat(ComputePass):
    slots = _grids
    workgroup = (64, 1, 1)
    file = "splat.wgsl"


class _Merge(ComputePass):
    slots = (
        *_grids,
        storage("density", "f32"),
        storage("merged", "vec4f", "read_write"),
        storage("deposits", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "merge.wgsl"


class Merge:
    """`merged`, vec4 [z][y][x]: in-scattered radiance per unit scattering coefficient."""

    def __init__(self, medium: GridMedium, grids: Grids, merged: Buffer | None = None) -> None:
        """`merged`: the buffer of another pass to fill, if any."""
        gpu, cells = medium.gpu, medium.cells
        self._medium, self._grids = medium, grids
        self.merged = merged or Buffer(gpu, "merged light", 16 * cells)
        # Three integers per cell: atomics add in fixed point.
        self._splatted = Buffer(gpu, "residuum of local lights", 12 * cells)
        self._splat, self._merge = _Splat(gpu), _Merge(gpu)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        hops: GridParams,
        gathered: Buffer,
        deposits: Buffer,
    ) -> None:
        """Fill `merged`, and `deposits` as `delta.deposit` does; or add to them."""
        grids = self._grids
        common = {
            "params": params,
            "hops": hops,
            **grids.bound,
            "gathered": gathered,
            "splatted": self._splatted,
        }
        # Shells around local lights add to cells; parallel grids are read by them.
        radial = grids.local + grids.virtual
        if radial:
            self._splat.dispatch(commands, (grids.capacity, radial), **common)
        self._merge.dispatch(
            commands,
            (self._medium.cells,),
            **common,
            density=self._medium.density.cells,
            merged=self.merged,
            deposits=deposits,
        )
