"""One iteration of propagation to 26 neighbours (Billeter2012 eq. 3, ours by default).

A step computes after = source + K before. K is M, which makes the next state of one, or T, which
gives the track that a state leaves behind. The sum of all states, Q = I + M Q, is stepped itself,
and its track T Q is taken once at the end.
differs: Billeter2012 section 4.2 accumulates every state into a third lattice.

    wgsl/hops26          the 26 hops: weights, lengths, numbers
    wgsl/step26          what a cell and one neighbour exchange; the sum over all
    propagate.wgsl       a cell and channel per invocation
    propagate_rows.wgsl  the same for CPU adapters whose lanes see one another (`gpu.lanes`)
"""

from __future__ import annotations

import enum
import os
from dataclasses import dataclass

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES, has_row_lanes
from ..gpu.layout import Struct, f32, u32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import Slot, storage, uniform
from ..maths.lattice26 import RHO
from .coefficients import CHANNELS, StepCoefficients

Count = tuple[int, int, int]
TILE = (4, 2)
"""Columns and rows of cells that a lane of propagate_rows.wgsl marches."""
_GROUPS, _THINNEST = 6, 8
"""Workgroups that a processor should have at least, and the layers of the thinnest slab."""


class Operator(enum.Enum):
    """What a step applies to a state."""

    MOVE = enum.auto()
    """M, which gives the next state, W."""
    TRACK = enum.auto()
    """T, which gives the track, W m."""


class StepParams(Struct):
    """A lattice's size, and what a step makes of it."""

    count = vec3u("cells")
    row = u32("of the coefficients, for channel 0")
    slabs = u32("slabs along z, which invocations march, of equally many layers")
    cell = f32("m")
    straight = f32("net direction of what arrives, per 3 W")
    is_track = u32("1: the track, not the next state")


@dataclass(frozen=True)
class StepMedium:
    """A lattice and what is in its cells."""

    count: Count
    cell_m: float
    medium: Buffer
    """Where it varies: (sigma_s, sigma_t), m^-1, per channel and cell."""
    coefficients: Buffer
    """Where it is homogeneous: rows of StepCoefficients, M of three channels, then T of them."""
    packs: Buffer
    """Visibility of the hops (see hop_visibility); read where there are walls."""
    persistence: float = RHO**2
    """Share of its net direction that light keeps on a hop (maths.lattice26.persistence)."""

    def params(self, operator: Operator, *, slabs: int) -> StepParams:
        """As shaders read it: M and T share a pipeline."""
        is_track = operator is Operator.TRACK
        return StepParams.of(
            count=self.count,
            row=CHANNELS * is_track,
            slabs=slabs,
            cell=self.cell_m,
            straight=self.persistence / RHO,
            is_track=int(is_track),
        )


def _slots(light: str, medium: str, packs: str) -> tuple[Slot, ...]:
    return (
        uniform("params", StepParams),
        storage("coefficients", StepCoefficients),
        storage("medium", medium),
        storage("packs", packs),
        storage("before", light),
        storage("source", light),
        storage("after", light, "read_write"),
    )


class _Cells(ComputePass):
    """x, y and z of a workgroup run over cells, channels stacked along z."""

    slots = _slots("vec4f", "vec2f", "vec4u")
    workgroup = (32, 4, 2)
    file = "propagate.wgsl"


class _Rows(ComputePass):
    """A workgroup's lanes share rows of cells; all is read in pairs of cells."""

    slots = _slots("vec4<u64>", "vec2<u64>", "vec4<u64>")
    workgroup = (LANES, 1, 1)
    file = "propagate_rows.wgsl"


class Step:
    """Runs steps on lattices of any size, all of them with walls or none, varying or none."""

    def __init__(
        self,
        gpu: Gpu,
        *,
        has_walls: bool,
        is_varied: bool,
        handed_on: float = 0.0,
        has_rows: bool | None = None,
    ) -> None:
        """`has_rows` chooses the kernel of rows; by default on CPU adapters that have the lanes.

        `handed_on`, where media vary: steps are eq. 3's as printed, which hands on this share of
        what scatters (coefficients.handed_on); 0: steps are ours.
        """
        self._gpu = gpu
        self._has_rows = has_row_lanes(gpu) if has_rows is None else has_rows
        # Walls and varying media are compiled in; all operators share the kernel.
        self._constants = {"HAS_WALLS": float(has_walls), "IS_VARIED": float(is_varied)}
        self._constants["HANDED_ON"] = handed_on if is_varied else 0.0
        # Compiled when first needed: most lattices need one of the two.
        self._kernels: dict[type[ComputePass], ComputePass] = {}

    def begin(self, count: Count) -> None:
        """Start compiling what lattices of `count` cells need."""
        self._kernel(_Rows if self._is_by_rows(count[0]) else _Cells).begin()

    def _is_by_rows(self, nx: int) -> bool:
        """Rows are read in pairs of cells, so that all of them must begin with a pair."""
        return self._has_rows and nx % 2 == 0

    def encode(
        self,
        commands: Commands,
        lattice: StepMedium,
        operator: Operator,
        *,
        before: Buffer,
        source: Buffer,
        after: Buffer,
    ) -> None:
        """after = source + K before; W per cell and channel, W m where the operator is a track."""
        nx, ny, nz = lattice.count
        # CPU adapters: rows of lanes, in slabs for all cores; else a cell per invocation.
        by_rows = self._is_by_rows(nx)
        x, y, slabs = tiles(lattice.count, os.cpu_count() or 1) if by_rows else (nx, ny, nz)
        self._kernel(_Rows if by_rows else _Cells).dispatch(
            commands,
            (x, y, CHANNELS * slabs),
            params=lattice.params(operator, slabs=slabs),
            coefficients=lattice.coefficients,
            medium=lattice.medium,
            packs=lattice.packs,
            before=before,
            source=source,
            after=after,
        )

    def _kernel(self, kind: type[ComputePass]) -> ComputePass:
        if kind not in self._kernels:
            self._kernels[kind] = kind(self._gpu, constants=self._constants)
        return self._kernels[kind]


def tiles(count: Count, processors: int) -> Count:
    """Tiles along x and y, and slabs along z: as few as leave every processor some of them.

    Slabs read the layers beside them, too.
    """
    nx, ny, nz = count
    # A lane marches a tile of columns; enough slabs leave every processor some groups.
    x, y = -(-nx // TILE[0]), -(-ny // TILE[1])
    groups = CHANNELS * -(-x // LANES) * y
    slabs = min(-(-_GROUPS * processors // groups), max(1, nz // _THINNEST))
    # As many as layers are left for.
    return x, y, -(-nz // -(-nz // slabs))
