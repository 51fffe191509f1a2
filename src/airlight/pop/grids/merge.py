"""All grids' light on the medium's own cells (Elek2014 section 5.3), and what they hand over.

Parallel grids are read trilinearly, weighted by density. The residuum around lamps, whose cells are
smaller than the medium's where it matters, is added up in fixed point: the same bits every time.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ..medium.placement import MediumParams, MediumPlacement
from .grids import HopGridData, HopGrids, HopParams

_grids = (
    uniform("params", MediumParams),
    uniform("hops", HopParams),
    storage("grids", HopGridData),
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

    def __init__(self, gpu: Gpu, placement: MediumPlacement, merged: Buffer | None = None) -> None:
        """Into `merged`, where that is another's."""
        self.cells = placement.cells
        self.merged = merged or Buffer(gpu, "merged light", 16 * placement.cells)
        self._splatted = Buffer(gpu, "residuum of lamps", 12 * placement.cells)
        self._splat, self._merge = _Splat(gpu), _Merge(gpu)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        hops: HopParams,
        grids: HopGrids,
        gathered: Buffer,
        density: Buffer,
        deposits: Buffer,
    ) -> None:
        """Fill `merged`, and `deposits` as `Deposit` does; or add to them."""
        common = {
            "params": params,
            "hops": hops,
            "grids": grids.rows,
            "solid_angles": grids.solid_angles,
            "gathered": gathered,
            "splatted": self._splatted,
            "hop_rho": grids.density,
        }
        around = grids.lamps + grids.virtual
        if around:
            self._splat.dispatch(commands, (grids.capacity, around), **common)
        self._merge.dispatch(
            commands,
            (self.cells,),
            **common,
            density=density,
            merged=self.merged,
            deposits=deposits,
        )
