"""One step to 26 neighbours among walls, where lanes see one another.

As propagate_rows: lanes share rows, each with 4 x 2 of their cells, and read cells, walls and what
is added 32 bytes at a time. Of the processor time of columns of 2 x 2 it takes .6, .75 where rows
are a little longer than a run of lanes.
"""

from __future__ import annotations

import os

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS, StepCoefficients, StepParams
from .hop_wgsl import constants, gathered_blocked, offsets
from .propagate_rows import row_place, tiles_for

Count = tuple[int, int, int]
WIDTH, HEIGHT = 4, 2
"""Cells along x and y that one invocation marches."""
_COLUMNS = WIDTH + 2


class WallRows(ComputePass):
    """after = source + K before, K by visibility packs (see walls), on rows of an even number."""

    slots = (
        uniform("params", StepParams),
        storage("coefficients", StepCoefficients),
        storage("before", "vec4<u64>"),
        storage("source", "vec4<u64>"),
        storage("after", "vec4<u64>", "read_write"),
        storage("packs", "vec4<u64>"),
    )
    workgroup = (LANES, 1, 1)
    file = "propagate_walls.wgsl"

    def __init__(self, gpu: Gpu) -> None:
        super().__init__(gpu, generated=f"{constants()}\n{gathered_blocked()}\n{_wgsl()}")

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
    ) -> None:
        """As propagate.Step.encode."""
        x, y, slabs = tiles_for(count, WIDTH, HEIGHT, os.cpu_count() or 1)
        self.dispatch(
            commands,
            (x, y, CHANNELS * slabs),
            params=StepParams.of(count=count, row=row, slabs=slabs, own=0.0),
            coefficients=coefficients,
            before=before,
            source=source,
            after=after,
            packs=packs,
        )


def _wgsl() -> str:
    """A layer's rows, how they are read, the step of each cell, and how pairs are stored."""
    fields = "".join(f"    v{k}: vec4f,\n" for k in range((HEIGHT + 2) * _COLUMNS))
    return "\n".join(
        [
            "//! use cell_pairs",
            f"const WIDTH = {WIDTH}u;\nconst HEIGHT = {HEIGHT}u;",
            f"struct Layer {{\n{fields}}}",
            "fn layer_at(n: vec3u, c: StepCoefficients, base: u32, at: vec2u, is_there: bool)"
            " -> Layer {",
            "    var layer: Layer;",
            "    let is_first = at.x == 0u;",
            "    let is_last = at.x + WIDTH >= n.x;",
            f"    let lane = (at.x / WIDTH) % {LANES}u;",
            *(line for row in range(HEIGHT + 2) for line in _row(row)),
            "    return layer;",
            "}",
            *_stepped(),
            *_store(),
        ]
    )


def _row(row: int) -> list[str]:
    """A row's cells and the two beside them; what lies beyond the lattice is dark."""
    inside, y = row_place(row - 1)
    first, last = row * _COLUMNS, row * _COLUMNS + WIDTH + 1
    lines = [
        f"    let g{row} = select(vec4f(0.0), c.gain, is_there && {inside});",
        f"    let b{row} = base + {y} * n.x;",
    ]
    for k in range(0, WIDTH, 2):
        place = f"min(at.x + {k}u, n.x - 2u)" if k else "at.x"
        gain = f"select(vec4f(0.0), g{row}, at.x + {k}u < n.x)" if k else f"g{row}"
        lines += [
            f"    let p{row}_{k} = cell_pair(before[(b{row} + {place}) >> 1u]);",
            f"    layer.v{first + 1 + k} = p{row}_{k}.a * {gain};",
            f"    layer.v{first + 2 + k} = p{row}_{k}.b * {gain};",
        ]
    return [
        *lines,
        f"    var w{row} = subgroupShuffleUp(layer.v{last - 1}, 1u);",
        f"    var e{row} = subgroupShuffleDown(layer.v{first + 1}, 1u);",
        "    if (lane == 0u && !is_first) {",
        f"        w{row} = cell_pair(before[((b{row} + at.x) >> 1u) - 1u]).b * g{row};",
        "    }",
        f"    if (lane == {LANES - 1}u && !is_last) {{",
        f"        e{row} = cell_pair(before[(b{row} + at.x + WIDTH) >> 1u]).a * g{row};",
        "    }",
        f"    layer.v{first} = select(w{row}, vec4f(0.0), is_first);",
        f"    layer.v{last} = select(e{row}, vec4f(0.0), is_last);",
    ]


def _stepped() -> list[str]:
    """`stepped`: what the tile's cells hold next."""
    layers = {-1: "below", 0: "here", 1: "above"}
    results = "".join(f"    v{k}: vec4f,\n" for k in range(WIDTH * HEIGHT))
    lines = [
        f"struct Stepped {{\n{results}}}",
        "fn stepped(n: vec3u, c: StepCoefficients, below: Layer, here: Layer, above: Layer, "
        "channel: u32, cell: u32) -> Stepped {",
        "    var tile: Stepped;",
    ]
    for k in range(WIDTH * HEIGHT):
        row, column = divmod(k, WIDTH)
        own = _COLUMNS * (1 + row) + 1 + column
        seen = [f"{layers[z]}.v{own + _COLUMNS * y + x}" for x, y, z in ((0, 0, 0), *offsets())]
        packs = [f"bitcast<vec4u>({way}{k}.{half})" for way in ("in", "out") for half in "ab"]
        lines += [
            f"    let i{k} = 2u * (cell + {row}u * n.x + {column}u);",
            f"    let in{k} = cell_pair(packs[i{k}]);",
            f"    let out{k} = cell_pair(packs[i{k} + 1u]);",
            f"    tile.v{k} = gathered_blocked({', '.join(['c', *seen, *packs, 'channel'])});",
        ]
    return [*lines, "    return tile;", "}"]


def _store() -> list[str]:
    lines = ["fn store(n: vec3u, index: u32, at: vec2u, tile: Stepped) {"]
    for k in range(0, WIDTH * HEIGHT, 2):
        row, column = divmod(k, WIDTH)
        lines += [
            f"    if (at.x + {column}u < n.x && {row_place(row)[0]}) {{",
            f"        let place = (index + {row}u * n.x + {column}u) >> 1u;",
            "        let s = cell_pair(source[place]);",
            f"        after[place] = cell_pair_bits(s.a + tile.v{k}, s.b + tile.v{k + 1});",
            "    }",
        ]
    return [*lines, "}"]
