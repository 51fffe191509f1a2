"""One step to 26 neighbours among walls, where lanes see one another.

As propagate_rows: lanes share a row, each with four of its cells, and read cells, walls and what is
added 32 bytes at a time. Of the processor time of columns of 2 x 2 it takes .7 to .75, and .9 where
rows are a little longer than a run of lanes.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS, StepCoefficients, StepParams
from .hop_wgsl import constants, gathered_blocked, offsets

Count = tuple[int, int, int]
SLAB, WIDTH = 8, 4
"""Layers that one invocation marches through, and its cells along x."""
_COLUMNS = WIDTH + 2


class WallRows(ComputePass):
    """after = source + K before, K by openness packs (see walls), on rows of an even number."""

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
        self, commands: Commands, count: Count, coefficients: Buffer, row: int, *,
        before: Buffer, source: Buffer, after: Buffer, packs: Buffer,
    ) -> None:  # fmt: skip
        """As propagate.Step.encode."""
        nx, ny, nz = count
        slabs = -(-nz // SLAB)
        self.dispatch(
            commands, (-(-nx // WIDTH), ny, CHANNELS * slabs),
            params=StepParams.of(count=count, row=row, slabs=slabs, own=0.0),
            coefficients=coefficients, before=before, source=source, after=after, packs=packs,
        )  # fmt: skip


def _wgsl() -> str:
    """A layer's three rows, how they are read, the step of each cell, and how pairs are stored."""
    fields = "".join(f"    v{k}: vec4f,\n" for k in range(3 * _COLUMNS))
    results = "".join(f"    v{k}: vec4f,\n" for k in range(WIDTH))
    return "\n".join([
        "//! use cell_pairs", f"const WIDTH = {WIDTH}u;",
        f"struct Layer {{\n{fields}}}", f"struct Stepped {{\n{results}}}",
        "fn layer_at(n: vec3u, c: StepCoefficients, base: u32, at: vec2u, is_there: bool)"
        " -> Layer {",
        "    var layer: Layer;",
        "    let is_first = at.x == 0u;", "    let is_last = at.x + WIDTH >= n.x;",
        f"    let lane = (at.x / WIDTH) % {LANES}u;",
        *(line for row in range(3) for line in _row(row)),
        "    return layer;", "}",
        *(_stepped(i) for i in range(WIDTH)),
        "fn store(n: vec3u, index: u32, at: vec2u, tile: Stepped) {", *_stores(), "}",
    ])  # fmt: skip


def _row(row: int) -> list[str]:
    """A row's cells and the two beside them; what lies beyond the lattice is dark."""
    y, inside = (
        ("(max(at.y, 1u) - 1u)", "at.y > 0u"), ("at.y", "true"),
        ("min(at.y + 1u, n.y - 1u)", "at.y + 1u < n.y"),
    )[row]  # fmt: skip
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
        f"        w{row} = cell_pair(before[((b{row} + at.x) >> 1u) - 1u]).b * g{row};", "    }",
        f"    if (lane == {LANES - 1}u && !is_last) {{",
        f"        e{row} = cell_pair(before[(b{row} + at.x + WIDTH) >> 1u]).a * g{row};", "    }",
        f"    layer.v{first} = select(w{row}, vec4f(0.0), is_first);",
        f"    layer.v{last} = select(e{row}, vec4f(0.0), is_last);",
    ]  # fmt: skip


def _stepped(i: int) -> str:
    """`stepped_{i}`: what the lane's cell i holds next."""
    layers = {-1: "below", 0: "here", 1: "above"}

    def value(x: int, y: int, z: int) -> str:
        return f"{layers[z]}.v{_COLUMNS * (1 + y) + 1 + i + x}"

    names = ", ".join(["c", value(0, 0, 0), *(value(*o) for o in offsets())])
    return (
        f"fn stepped_{i}(c: StepCoefficients, below: Layer, here: Layer, above: Layer, "
        "channel: u32, cell: u32) -> vec4f {\n"
        "    let arriving = cell_pair(packs[2u * cell]);\n"
        "    let leaving = cell_pair(packs[2u * cell + 1u]);\n"
        f"    return gathered_blocked({names}, bitcast<vec4u>(arriving.a), "
        "bitcast<vec4u>(arriving.b),\n        bitcast<vec4u>(leaving.a), "
        "bitcast<vec4u>(leaving.b), channel);\n}"
    )


def _stores() -> list[str]:
    lines = []
    for k in range(0, WIDTH, 2):
        lines += [
            f"    if (at.x + {k}u < n.x) {{", f"        let place = (index + {k}u) >> 1u;",
            "        let s = cell_pair(source[place]);",
            f"        after[place] = cell_pair_bits(s.a + tile.v{k}, s.b + tile.v{k + 1});",
            "    }",
        ]  # fmt: skip
    return lines
