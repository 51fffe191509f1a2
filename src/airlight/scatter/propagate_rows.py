"""One step to 26 neighbours in a homogeneous medium without walls, where lanes see one another.

As propagate_open, for CPU adapters of which gpu.lanes says that eight invocations along x are
lanes of one vector. They share a row: each loads the cells of its own columns, two at a time as
64-bit integers, and has the columns beside them from the lanes beside it. Of the processor time of
propagate_open's tiles it takes .5.
"""

from __future__ import annotations

import os
from collections.abc import Mapping

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES, Rows
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS, StepCoefficients, StepParams
from .hop_wgsl import constants

Count = tuple[int, int, int]
_HEIGHTS = {8: 1.0, 6: 1.0, 4: 1.08, 2: 1.25}
"""Rows of a tile, and what a cell costs in it; measured."""
_GROUPS = 6
"""Workgroups that a processor should have at least, and the layers of the thinnest slab."""
_THINNEST = 8


def rows_for(count: Count) -> Rows | None:
    """How a lattice is cut; none where rows begin in the middle of a pair of cells."""
    nx, ny, _ = count
    return None if nx % 2 else Rows.of(nx, height_for(nx, ny, _HEIGHTS))


def height_for(nx: int, ny: int, costs: Mapping[int, float]) -> int:
    """The height, of those that have a cost per cell, of the tiles that cost least in all."""
    tallest = 4 if Rows.of(nx, 1).width == 8 else 8
    fitting = {h: -(-ny // h) * h * cost for h, cost in costs.items() if h <= tallest}
    return min(fitting, key=lambda h: fitting[h])


def tiles_for(count: Count, width: int, height: int, processors: int) -> tuple[int, int, int]:
    """Tiles along x and y, and slabs along z: as few as leave every processor some of them.

    Slabs read the layers beside them, too.
    """
    nx, ny, nz = count
    x, y = -(-nx // width), -(-ny // height)
    groups = CHANNELS * -(-x // LANES) * y
    slabs = min(-(-_GROUPS * processors // groups), max(1, nz // _THINNEST))
    # As many as layers are left for.
    return x, y, -(-nz // -(-nz // slabs))


class RowPass(ComputePass):
    """A pass over rows that lanes share; `generated` holds `march`."""

    slots = (
        uniform("params", StepParams),
        storage("coefficients", StepCoefficients),
        storage("before", "vec4<u64>"),
        storage("source", "vec4<u64>"),
        storage("after", "vec4<u64>", "read_write"),
    )
    workgroup = (LANES, 1, 1)
    file = "propagate_rows.wgsl"

    def __init__(self, gpu: Gpu, rows: Rows, march: list[str]) -> None:
        self.rows = rows
        sizes = f"const WIDTH = {rows.width}u;\nconst HEIGHT = {rows.height}u;"
        text = "\n".join(["//! use cell_pairs", constants(), sizes, *march])
        super().__init__(gpu, generated=text)

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
        own: float = 0.0,
    ) -> None:
        """As propagate.Step.encode; adds `own` of `before` to what a single step gives."""
        x, y, slabs = tiles_for(count, *self.rows[:2], os.cpu_count() or 1)
        self.dispatch(
            commands,
            (x, y, CHANNELS * slabs),
            params=StepParams.of(count=count, row=row, slabs=slabs, own=own),
            coefficients=coefficients,
            before=before,
            source=source,
            after=after,
        )


class OpenRows(RowPass):
    """after = K before (+ source), without walls, on lattices that `rows` cuts."""

    def __init__(self, gpu: Gpu, rows: Rows, *, is_added: bool) -> None:
        super().__init__(gpu, rows, _march(rows, is_added))


def _march(rows: Rows, is_added: bool) -> list[str]:
    """`march`: `e{k}` and `t{k}` are what the layers so far send to the one before and this one."""
    width, height = rows.width, rows.height
    lines = [
        *opening(rows),
        *held("e", width * height),
        *held("t", width * height),
        "    let end = min(z_last, n.z - 1u);",
        "    var z = max(at.z, 1u) - 1u;",
        # One loop for all layers, those beside the slab too, with its test at its end.
        "    loop {",
        "        let base = first + z * n.x * n.y;",
        "        let index = first + ((z - 1u) * n.y + at.y) * n.x + at.x;",
    ]
    for y in range(height + 2):
        lines += [*read(rows, y, y - 1, "true"), *summed(rows, "v", "r", y)]
        if y < 2:
            continue
        lines += sent(rows, "s", "r", y - 2)
        names = [(f"{width * (y - 2) + i}", f"s{y - 2}_{i}") for i in range(width)]
        whole = [f"e{k} + {s}.below" for k, s in names]
        lines += stored(rows, y - 2, whole, "z > at.z", is_added)
        lines += [f"e{k} = t{k} + {s}.here; t{k} = {s}.above;" for k, s in names]
    lines += [
        "        z++;",
        "        if (z > end) {",
        "            break;",
        "        }",
        "    }",
        "    let index = first + ((n.z - 1u) * n.y + at.y) * n.x + at.x;",
    ]
    for y in range(height):
        whole = [f"e{width * y + i}" for i in range(width)]
        lines += stored(rows, y, whole, "z_last == n.z", is_added)
    return [*lines, "}"]


def opening(rows: Rows) -> list[str]:
    """The head of `march` and what all its rows ask for."""
    return [
        "fn march(n: vec3u, c: StepCoefficients, w: Weights, first: u32, at: vec3u, z_last: u32) {",
        "    let is_first = at.x == 0u;",
        "    let is_last = at.x + WIDTH >= n.x;",
        f"    let lane = (at.x / WIDTH) % {LANES}u;",
    ]


def held(name: str, number: int) -> list[str]:
    """So many variables, dark at first."""
    return [f"    var {name}{k} = vec4f(0.0);" for k in range(number)]


def read(rows: Rows, y: int, offset: int, inside: str) -> list[str]:
    """`v{y}_{x}`: a row's columns and the two beside them; `offset` rows from the tile's first."""
    within, place = row_place(offset)
    lines = [
        f"    let g{y} = {inside} && {within};",
        f"    let b{y} = base + {place} * n.x + at.x;",
    ]
    for k in range(0, rows.width, 2):
        # A pair beyond the row is read at its end and left out.
        there, pair = f"g{y}", f"b{y} + {k}u"
        if rows.is_ragged and k:
            there = f"g{y} && at.x + {k}u < n.x"
            pair = f"b{y} + min({k}u, n.x - 2u - at.x)"
        lines += [
            f"    let p{y}_{k} = cell_pair(before[({pair}) >> 1u]);",
            f"    let v{y}_{k + 1} = select(vec4f(0.0), p{y}_{k}.a, {there});",
            f"    let v{y}_{k + 2} = select(vec4f(0.0), p{y}_{k}.b, {there});",
        ]
    lines += beside(rows, "v", y)
    if rows.is_whole:
        return lines
    end = rows.width + 1
    return [
        *lines,
        f"    if (lane == 0u && !is_first && g{y}) {{",
        f"        v{y}_0 = cell_pair(before[(b{y} >> 1u) - 1u]).b;",
        "    }",
        f"    if (lane == {LANES - 1}u && !is_last && g{y}) {{",
        f"        v{y}_{end} = cell_pair(before[(b{y} + WIDTH) >> 1u]).a;",
        "    }",
    ]


def row_place(offset: int) -> tuple[str, str]:
    """Whether a row `offset` rows from the tile's first is in the lattice, and a row that is."""
    if offset < 0:
        return f"at.y >= {-offset}u", f"(max(at.y, {-offset}u) - {-offset}u)"
    if offset == 0:
        return "true", "at.y"
    return f"at.y + {offset}u < n.y", f"min(at.y + {offset}u, n.y - 1u)"


def beside(rows: Rows, name: str, y: int) -> list[str]:
    """The columns of the lanes before and after this one, dark beyond the lattice."""
    first, last = f"{name}{y}_0", f"{name}{y}_{rows.width + 1}"
    up, down = f"{name}{y}_{rows.width}", f"{name}{y}_1"
    # A lane beside this one may hold another row's end, or nothing.
    return [
        f"    var {first} = select(subgroupShuffleUp({up}, 1u), vec4f(0.0), is_first);",
        f"    var {last} = select(subgroupShuffleDown({down}, 1u), vec4f(0.0), is_last);",
    ]


def summed(rows: Rows, name: str, sums: str, y: int) -> list[str]:
    """`{sums}{y}_{x}`: a row's sums and differences along x."""
    lines = []
    for x in range(rows.width):
        here, west, east = (f"{name}{y}_{x + k}" for k in (1, 0, 2))
        lines.append(f"    let {sums}{y}_{x} = Row({here}, {east} + {west}, {east} - {west});")
    return lines


def sent(rows: Rows, name: str, sums: str, y: int) -> list[str]:
    """`{name}{y}_{x}`: what rows y, y + 1 and y + 2 of `sums` send to three layers."""
    return [
        f"    let {name}{y}_{x} = sent(c, w, "
        + ", ".join(f"{sums}{y + k}_{x}" for k in range(3))
        + ");"
        for x in range(rows.width)
    ]


def stored(rows: Rows, y: int, values: list[str], condition: str, is_added: bool) -> list[str]:
    """A row of `after`, `index` at the tile's first cell."""
    lines = [f"    if ({condition} && {row_place(y)[0]}) {{"]
    for k in range(0, rows.width, 2):
        given = values[k : k + 2]
        if is_added:
            given = [f"s.{part} + ({value})" for part, value in zip("ab", given, strict=True)]
        inside = f"at.x + {k}u < n.x" if rows.is_ragged and k else ""
        lines += [
            f"        {f'if ({inside}) ' if inside else ''}{{",
            f"            let place = (index + {y}u * n.x + {k}u) >> 1u;",
            *(["            let s = cell_pair(source[place]);"] if is_added else []),
            f"            after[place] = cell_pair_bits({', '.join(given)});",
            "        }",
        ]
    return [*lines, "    }"]
