"""One step through air that varies, where lanes see one another.

As propagate_walls: lanes share rows, each with 4 x 2 of their cells. What a cell's air does to half
a hop is worked out once, where the cell is read, in place of once for each of the 26 that ask. Of
the processor time of propagate_varied's cells it takes .24 in the open and .3 among walls.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES
from ..gpu.layout import Struct
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS
from .hop_wgsl import constants, offsets
from .propagate_rows import row_place
from .varied_hop_wgsl import gathered_varied

Count = tuple[int, int, int]
SLAB, WIDTH, HEIGHT = 16, 4, 2
"""Layers that one invocation marches through, and its cells along x and y."""
_COLUMNS = WIDTH + 2


def takes_rows(count: Count) -> bool:
    """Whether rows begin with a pair of cells; else the plain kernel serves."""
    return count[0] % 2 == 0


def is_whole_row(count: Count) -> bool:
    """Whether a row's lanes hold all of it, so that nothing beside them is read."""
    return count[0] <= LANES * WIDTH


class VariedRows(ComputePass):
    """after = source + K before, as propagate_varied.VariedStep, where `takes_rows`."""

    workgroup = (LANES, 1, 1)
    file = "propagate_varied_rows.wgsl"

    def __init__(
        self, gpu: Gpu, params: type[Struct], *, is_track: bool, is_blocked: bool, is_whole: bool
    ) -> None:
        """Without `is_whole` for rows of any length."""
        self.slots = (  # type: ignore[misc]
            uniform("params", params),
            storage("medium", "vec2<u64>"),
            storage("before", "vec4<u64>"),
            storage("source", "vec4<u64>"),
            storage("after", "vec4<u64>", "read_write"),
            storage("packs", "vec4<u64>"),
        )
        texts = [
            "//! use cell_pairs",
            f"const WIDTH = {WIDTH}u;\nconst HEIGHT = {HEIGHT}u;\nconst SLAB = {SLAB}u;",
            f"const IS_TRACK = {str(is_track).lower()};",
            constants(),
            gathered_varied(is_track=is_track, is_blocked=is_blocked),
            *_layer(is_whole),
            *_stepped(is_blocked),
            *_store(),
        ]
        super().__init__(gpu, generated="\n".join(texts))

    def encode(self, commands: Commands, count: Count, **values: Any) -> None:
        """`values` name every slot."""
        nx, ny, nz = count
        slabs = -(-nz // SLAB)
        self.dispatch(commands, (-(-nx // WIDTH), -(-ny // HEIGHT), CHANNELS * slabs), **values)


def _layer(is_whole: bool) -> list[str]:
    """A layer's rows, those beside the tile too, and how they are read."""
    fields = "".join(f"    v{k}: Cell,\n" for k in range((HEIGHT + 2) * _COLUMNS))
    return [
        f"struct Layer {{\n{fields}}}",
        "fn layer_at(n: vec3u, base: u32, at: vec2u, is_there: bool) -> Layer {",
        "    var layer: Layer;",
        "    let is_first = at.x == 0u;",
        "    let is_last = at.x + WIDTH >= n.x;",
        f"    let lane = (at.x / WIDTH) % {LANES}u;",
        *(line for row in range(HEIGHT + 2) for line in _row(row, is_whole)),
        "    return layer;",
        "}",
    ]


def _row(row: int, is_whole: bool) -> list[str]:
    """A row's cells and the two beside them; beyond the lattice are the border's, without light."""
    inside, place = row_place(row - 1)
    first, last = row * _COLUMNS, row * _COLUMNS + WIDTH + 1
    lines = [
        f"    let g{row} = is_there && {inside};",
        f"    let b{row} = base + {place} * n.x + at.x;",
    ]
    for k in range(0, WIDTH, 2):
        there, pair, sigma = f"g{row}", f"b{row} + {k}u", f"s{row}_{k}.x"
        if k:
            # A pair beyond the row is read at its end: dark, and in the air of the row's last cell.
            there, pair = f"g{row} && at.x + {k}u < n.x", f"b{row} + min({k}u, n.x - 2u - at.x)"
            sigma = f"select(s{row}_{k}.y, s{row}_{k}.x, at.x + {k}u < n.x)"
        lines += [
            f"    let i{row}_{k} = ({pair}) >> 1u;",
            f"    let t{row}_{k} = {there};",
            f"    let s{row}_{k} = medium[i{row}_{k}];",
            f"    let p{row}_{k} = cell_pair(before[i{row}_{k}]);",
            f"    layer.v{first + 1 + k} = lit(p{row}_{k}.a, {sigma}, t{row}_{k});",
            f"    layer.v{first + 2 + k} = lit(p{row}_{k}.b, s{row}_{k}.y, t{row}_{k});",
        ]
    west, east = f"layer.v{first + 1}", f"layer.v{last - 1}"
    lines += [f"    var w{row} = before_this({east});", f"    var e{row} = after_this({west});"]
    if not is_whole:
        lines += _read_beside(row)
    return [
        *lines,
        f"    layer.v{first} = edged(w{row}, {west}.air, is_first);",
        f"    layer.v{last} = edged(e{row}, {east}.air, is_last);",
    ]


def _read_beside(row: int) -> list[str]:
    """What the lanes of another vector hold is read."""
    return [
        "    if (lane == 0u && !is_first) {",
        f"        let place = (b{row} >> 1u) - 1u;",
        f"        w{row} = lit(cell_pair(before[place]).b, medium[place].y, g{row});",
        "    }",
        f"    if (lane == {LANES - 1}u && !is_last) {{",
        f"        let place = (b{row} + WIDTH) >> 1u;",
        f"        e{row} = lit(cell_pair(before[place]).a, medium[place].x, g{row});",
        "    }",
    ]


def _stepped(is_blocked: bool) -> list[str]:
    """`stepped`: what the tile's cells hold next."""
    layers = {-1: "below", 0: "here", 1: "above"}
    results = "".join(f"    v{k}: vec4f,\n" for k in range(WIDTH * HEIGHT))
    lines = [
        f"struct Stepped {{\n{results}}}",
        "fn stepped(n: vec3u, below: Layer, here: Layer, above: Layer, channel: u32, cell: u32)"
        " -> Stepped {",
        "    var tile: Stepped;",
    ]
    for k in range(WIDTH * HEIGHT):
        row, column = divmod(k, WIDTH)
        own = _COLUMNS * (1 + row) + 1 + column
        seen = [f"{layers[z]}.v{own + _COLUMNS * y + x}" for x, y, z in ((0, 0, 0), *offsets())]
        if is_blocked:
            lines += [
                f"    let i{k} = 2u * (cell + {row}u * n.x + {column}u);",
                f"    let in{k} = cell_pair(packs[i{k}]);",
                f"    let out{k} = cell_pair(packs[i{k} + 1u]);",
            ]
            seen += [f"bitcast<vec4u>({way}{k}.{half})" for way in ("in", "out") for half in "ab"]
        lines.append(f"    tile.v{k} = gathered({', '.join(seen)}, channel);")
    return [*lines, "    return tile;", "}"]


def _store() -> list[str]:
    lines = ["fn store(n: vec3u, index: u32, at: vec2u, tile: Stepped) {"]
    for k in range(0, WIDTH * HEIGHT, 2):
        row, column = divmod(k, WIDTH)
        inside = row_place(row)[0]
        if column:
            inside += f" && at.x + {column}u < n.x"
        lines += [
            f"    if ({inside}) {{",
            f"        let place = (index + {row}u * n.x + {column}u) >> 1u;",
            "        let s = cell_pair(source[place]);",
            f"        after[place] = cell_pair_bits(s.a + tile.v{k}, s.b + tile.v{k + 1});",
            "    }",
        ]
    return [*lines, "}"]
