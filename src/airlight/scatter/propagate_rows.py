"""One step to 26 neighbours in an even medium without walls, where lanes see one another.

As propagate_open, for software drivers of which gpu.lanes says that eight invocations along x are
lanes of one vector. They share a row: each loads the cells of its own columns, two at a time as
64-bit integers, and has the columns beside them from the lanes beside it. Of the processor time of
propagate_open's tiles it takes .55.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES, Rows
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS, StepCoefficients, StepParams
from .hop_wgsl import constants
from .propagate_open import SLAB, added_wgsl, sums_wgsl

Count = tuple[int, int, int]
_HEIGHTS = {8: 1.0, 4: 1.1, 2: 1.35}
"""Rows of a tile, and what a cell costs in it; measured."""


def rows_for(count: Count) -> Rows | None:
    """How a lattice is cut; none where rows begin in the middle of a pair of cells."""
    nx, ny, _ = count
    if nx % 2:
        return None
    tallest = 4 if Rows.of(nx, 1).width == 8 else 8
    costs = {h: -(-ny // h) * h * c for h, c in _HEIGHTS.items() if h <= tallest}
    return Rows.of(nx, min(costs, key=lambda h: costs[h]))


class OpenRows(ComputePass):
    """after = K before (+ source), without walls, on lattices that `rows` cuts."""

    slots = (
        uniform("params", StepParams),
        storage("coefficients", StepCoefficients),
        storage("before", "vec4<u64>"),
        storage("source", "vec4<u64>"),
        storage("after", "vec4<u64>", "read_write"),
    )
    workgroup = (LANES, 1, 1)
    file = "propagate_open.wgsl"

    def __init__(self, gpu: Gpu, rows: Rows, *, is_added: bool) -> None:
        self.rows = rows
        super().__init__(gpu, generated=f"{constants()}\n{_rows_wgsl(rows, is_added)}")

    def encode(
        self, commands: Commands, count: Count, coefficients: Buffer, row: int, *,
        before: Buffer, source: Buffer, after: Buffer,
    ) -> None:  # fmt: skip
        """As propagate.Step.encode."""
        nx, ny, nz = count
        slabs = -(-nz // SLAB)
        self.dispatch(
            commands, (-(-nx // self.rows.width), -(-ny // self.rows.height), CHANNELS * slabs),
            params=StepParams.of(count=count, row=row, slabs=slabs), coefficients=coefficients,
            before=before, source=source, after=after,
        )  # fmt: skip


def _rows_wgsl(rows: Rows, is_added: bool) -> str:
    """As propagate_open's `tile_wgsl`: the tile, how a layer is read and how it is stored."""
    width, height = rows.width, rows.height
    fields = "".join(f"    v{k}: vec4f,\n" for k in range(width * height))
    return "\n".join([
        "//! use cell_pairs",
        f"const SLAB = {SLAB}u;", f"const WIDTH = {width}u;", f"const HEIGHT = {height}u;",
        f"struct Tile {{\n{fields}}}",
        "struct Layer { below: Tile, here: Tile, above: Tile }",
        "fn layer_at(n: vec3u, c: StepCoefficients, w: Weights, base: u32, x: u32, y: u32)"
        " -> Layer {",
        "    var layer: Layer;", "    let is_first = x == 0u;",
        "    let is_last = x + WIDTH >= n.x;", f"    let lane = (x / WIDTH) % {LANES}u;",
        *(line for y in range(height + 2) for line in _row(rows, y)),
        *sums_wgsl(width, height), "    return layer;", "}",
        "fn store(at: vec2u, n: vec3u, index: u32, tile: Tile) {", *_stores(rows, is_added), "}",
        added_wgsl(width * height),
    ])  # fmt: skip


def _row(rows: Rows, y: int) -> list[str]:
    """`v{y}_{x}`: a row's columns and the two beside them; `r{y}_{x}`: sums and differences."""
    width = rows.width
    inside = "y > 0u" if y == 0 else f"y + {y - 1}u < n.y"
    at = "(max(y, 1u) - 1u)" if y == 0 else f"min(y + {y - 1}u, n.y - 1u)"
    lines = [
        f"    let g{y} = select(vec4f(0.0), c.gain, {inside});",
        f"    let b{y} = base + {at} * n.x;",
    ]
    for k in range(width // 2):
        # A pair beyond the row is read at its end and weighted by zero.
        place, gain = f"x + {2 * k}u", f"g{y}"
        if rows.is_ragged and k:
            gain = f"select(vec4f(0.0), g{y}, {place} < n.x)"
            place = f"min({place}, n.x - 2u)"
        lines += [
            f"    let p{y}_{k} = cell_pair(before[(b{y} + {place}) >> 1u]);",
            f"    let v{y}_{2 * k + 1} = p{y}_{k}.a * {gain};",
            f"    let v{y}_{2 * k + 2} = p{y}_{k}.b * {gain};",
        ]
    lines += _beside(rows, y)
    return lines + [
        f"    let r{y}_{x} = Row(v{y}_{x + 1}, v{y}_{x + 2} + v{y}_{x}, v{y}_{x + 2} - v{y}_{x});"
        for x in range(width)
    ]


def _beside(rows: Rows, y: int) -> list[str]:
    """The columns of the lanes before and after this one."""
    end = rows.width + 1
    lines = [
        f"    var v{y}_0 = subgroupShuffleUp(v{y}_{rows.width}, 1u);",
        f"    var v{y}_{end} = subgroupShuffleDown(v{y}_1, 1u);",
    ]
    if not rows.is_whole:
        lines += [
            "    if (lane == 0u && !is_first) {",
            f"        v{y}_0 = cell_pair(before[((b{y} + x) >> 1u) - 1u]).b * g{y};", "    }",
            f"    if (lane == {LANES - 1}u && !is_last) {{",
            f"        v{y}_{end} = cell_pair(before[(b{y} + x + WIDTH) >> 1u]).a * g{y};",
            "    }",
        ]  # fmt: skip
    return [
        *lines,
        f"    v{y}_0 = select(v{y}_0, vec4f(0.0), is_first);",
        f"    v{y}_{end} = select(v{y}_{end}, vec4f(0.0), is_last);",
    ]


def _stores(rows: Rows, is_added: bool) -> list[str]:
    lines = []
    for k in range(0, rows.width * rows.height, 2):
        y, x = divmod(k, rows.width)
        inside = f"at.y + {y}u < n.y" if y else "true"
        if rows.is_ragged and x:
            inside += f" && at.x + {x}u < n.x"
        given = [f"tile.v{k}", f"tile.v{k + 1}"]
        body = []
        if is_added:
            body = ["        let s = cell_pair(source[place]);"]
            given = [f"s.a + {given[0]}", f"s.b + {given[1]}"]
        lines += [
            f"    if ({inside}) {{", f"        let place = (index + {y}u * n.x + {x}u) >> 1u;",
            *body, f"        after[place] = cell_pair_bits({', '.join(given)});", "    }",
        ]  # fmt: skip
    return lines
