"""One step to 26 neighbours in a homogeneous medium (Billeter2012 eq. 3, ours by default).

A step computes after = source + K before, where K is M (the state one iteration on) or T (the
track length that a state leaves), by the rows of StepCoefficients it is given. So the sum of all
states, Q = I + M Q, is stepped itself, and its track T Q taken once at the end.
differs: Billeter2012 section 4.2 accumulates every state into a third lattice.

GPUs run a cell and channel per invocation. The CPU adapter pays for loads: there each
invocation marches columns of 2 x 2 cells along z and loads four neighbours a cell, not 26.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import Rows, has_row_lanes
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS, StepCoefficients, StepParams
from .hop_wgsl import COUNT, constants, gathered, gathered_blocked, offsets
from .propagate_open import TILES, OpenColumns, fitting
from .propagate_pairs import OpenPairs, pairs_for
from .propagate_rows import OpenRows, RowPass, rows_for
from .propagate_walls import WallRows

Count = tuple[int, int, int]
SLAB = 8
"""Layers that one invocation marches through."""
MOVE, TRACK = 0, CHANNELS
"""Where the rows of M and T stand in `step_rows`."""


_SLOTS = (
    uniform("params", StepParams),
    storage("coefficients", StepCoefficients),
    storage("before", "vec4f"),
    storage("source", "vec4f"),
    storage("after", "vec4f", "read_write"),
    storage("packs", "vec4u"),
)


class _Cells(ComputePass):
    """Plain gather: x, y and z of a workgroup run over cells, channels stacked along z."""

    slots = _SLOTS
    workgroup = (32, 4, 2)
    file = "propagate.wgsl"


class _Columns(ComputePass):
    """Columns of 2 x 2 cells marched along z."""

    slots = _SLOTS
    workgroup = (8, 8, 4)
    file = "propagate_columns.wgsl"


class Step:
    """Runs steps on lattices of any size; `is_blocked` reads visibility packs (see walls)."""

    def __init__(self, gpu: Gpu, *, is_blocked: bool, is_marched: bool | None = None) -> None:
        """`is_marched` chooses the kernel; by default columns on CPU adapters."""
        self.is_marched = gpu.takes_cpu_paths if is_marched is None else is_marched
        text = "\n".join([constants(), gathered_blocked() if is_blocked else gathered()])
        self._cells = _Cells(gpu, generated=f"{text}\n{_cell_call(is_blocked)}")
        self._columns: _Columns | None = None
        self._gpu, self._is_open = gpu, self.is_marched and not is_blocked
        self._has_rows = self._is_open and has_row_lanes(gpu)
        self._open = {tile: OpenColumns(gpu, tile) for tile in TILES if self._is_open}
        self._rows: dict[tuple[Rows, int, bool], RowPass] = {}
        has_walls = self.is_marched and is_blocked and has_row_lanes(gpu)
        self._walls = WallRows(gpu) if has_walls else None
        if self.is_marched:
            self._columns = _Columns(gpu, generated=f"{text}\n{_column_functions(is_blocked)}")

    def encode(
        self,
        commands: Commands,
        count: Count,
        coefficients: Buffer,
        row: int,
        *,
        before: Buffer,
        source: Buffer,
        after: Buffer,
        packs: Buffer,
        is_added: bool = True,
        steps: int = 1,
    ) -> None:
        """after = source + K before, K by the rows `row` .. `row` + 2 of `coefficients`.

        Where not `is_added`, `source` holds zeros, which need not be read. `steps` are as many as
        `at_once` allows: K K for 2.
        """
        nx, ny, nz = count
        slabs = -(-nz // SLAB)
        tile, rows = fitting(count), rows_for(count)
        given = {"before": before, "source": source, "after": after}
        values = {
            "params": StepParams.of(count=count, row=row, slabs=slabs, own=0.0),
            "coefficients": coefficients,
            "packs": packs,
            **given,
        }
        if self._has_rows and rows:
            # What is read anyway need not be read once more to be added.
            own = float(is_added and source is before and steps == 1)
            kernel = self._row_kernel(count, steps, is_added and not own)
            kernel.encode(commands, count, coefficients, row, **given, own=own)
        elif self._walls and rows:
            self._walls.encode(commands, count, coefficients, row, **given, packs=packs)
        elif tile in self._open:
            self._open[tile].encode(commands, count, coefficients, row, **given)
        # Columns come in pairs; a coarse lattice of odd size takes the plain kernel.
        elif self._columns and nx % 2 == 0 and ny % 2 == 0:
            self._columns.dispatch(commands, (nx // 2, ny // 2, CHANNELS * slabs), **values)
        else:
            self._cells.dispatch(commands, (nx, ny, CHANNELS * nz), **values)

    def leaves_out_zeros(self, count: Count) -> bool:
        """Whether a step without `is_added` is cheaper on such a lattice."""
        return self._has_rows and rows_for(count) is not None

    def at_once(self, count: Count) -> int:
        """How many steps may be taken at once on such a lattice."""
        return 2 if self._has_rows and pairs_for(count) else 1

    def _row_kernel(self, count: Count, steps: int, is_added: bool) -> RowPass:
        kind = OpenRows if steps == 1 else OpenPairs
        rows = rows_for(count) if steps == 1 else pairs_for(count)
        assert rows
        found = self._rows.get((rows, steps, is_added))
        if found is None:
            found = self._rows[rows, steps, is_added] = kind(self._gpu, rows, is_added=is_added)
        return found


def _arguments(names: list[str], is_blocked: bool) -> str:
    walls = ["packs[p]", "packs[p + 1u]", "packs[p + 2u]", "packs[p + 3u]", "channel"]
    return ", ".join(names + (walls if is_blocked else []))


def _function(is_blocked: bool) -> str:
    return "gathered_blocked" if is_blocked else "gathered"


def _cell_call(is_blocked: bool) -> str:
    """`stepped(at, channel, cell)`: what the cell holds next, its neighbours loaded one by one."""
    loads = [f"at_neighbour(at + vec3i({x}, {y}, {z}), channel)" for x, y, z in offsets()]
    names = ["c", "before[index] * c.gain", *loads]
    return (
        "fn stepped(c: StepCoefficients, at: vec3i, channel: u32, cell: u32, index: u32) -> vec4f "
        f"{{\n    let p = 4u * cell;\n    return {_function(is_blocked)}(\n        "
        f"{_arguments(names, is_blocked)});\n}}"
    )


def _column_functions(is_blocked: bool) -> str:
    """A layer's 4 x 4 columns, how they are loaded, and the step of the four in the middle."""
    fields = "".join(f"    v{k}: vec4f,\n" for k in range(16))
    lines = [f"struct Layer {{\n{fields}}}"]
    lines.append("fn loaded(base: u32, x: vec4u, y: vec4u, gain: mat4x4f, along: vec4f) -> Layer {")
    lines.append("    var layer: Layer;")
    for k in range(16):
        # Rows of `gain` weight what lies beyond the border, by column in x; `along` by row in y.
        lines.append(
            f"    layer.v{k} = before[base + y.{'xyzw'[k // 4]} + x.{'xyzw'[k % 4]}]"
            f" * (gain[{k % 4}] * along.{'xyzw'[k // 4]});"
        )
    lines += ["    return layer;", "}"]
    for tile in range(4):
        lines.append(_column_call(tile, is_blocked))
    return "\n".join(lines)


def _column_call(tile: int, is_blocked: bool) -> str:
    i, k = tile % 2, tile // 2
    layers = {-1: "below", 0: "here", 1: "above"}

    def value(x: int, y: int, z: int) -> str:
        return f"{layers[z]}.v{4 * (1 + k + y) + 1 + i + x}"

    names = ["c", value(0, 0, 0), *(value(*o) for o in offsets())]
    assert len(names) == COUNT + 2
    return (
        f"fn stepped_{tile}(c: StepCoefficients, below: Layer, here: Layer, above: Layer, "
        f"channel: u32, cell: u32) -> vec4f {{\n    let p = 4u * cell;\n"
        f"    return {_function(is_blocked)}(\n        {_arguments(names, is_blocked)});\n}}"
    )
