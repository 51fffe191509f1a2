"""One step to 26 neighbours in a homogeneous medium without walls, for CPU adapters.

As propagate's columns, but a layer's sums over 3 x 3 cells are made once, for the layer below it,
its own and the one above: a hop's power is linear in the state, so what nine cells send is a few
sums and differences along x and then y. Each invocation marches a tile of columns; loads and
stores are what costs, and of the tiles tried 4 x 4 columns need the least, 4.4 a cell.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from .coefficients import CHANNELS, StepCoefficients, StepParams
from .hop_wgsl import constants

Count = tuple[int, int, int]
Tile = tuple[int, int]
SLAB = 16
"""Layers that one invocation marches through."""
TILES: tuple[Tile, ...] = ((4, 4), (2, 2))
"""Columns along x and y that an invocation takes, best first."""


class OpenColumns(ComputePass):
    """after = source + K before, without walls, on lattices that `tile` fills."""

    slots = (
        uniform("params", StepParams),
        storage("coefficients", StepCoefficients),
        storage("before", "vec4f"),
        storage("source", "vec4f"),
        storage("after", "vec4f", "read_write"),
    )
    workgroup = (8, 4, 1)
    file = "propagate_open.wgsl"

    def __init__(self, gpu: Gpu, tile: Tile) -> None:
        self.tile = tile
        super().__init__(gpu, generated=f"{constants()}\n{_tile_wgsl(*tile)}")

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
    ) -> None:
        """As propagate.Step.encode."""
        nx, ny, nz = count
        slabs = -(-nz // SLAB)
        self.dispatch(
            commands,
            (nx // self.tile[0], ny // self.tile[1], CHANNELS * slabs),
            params=StepParams.of(count=count, row=row, slabs=slabs, own=0.0),
            coefficients=coefficients,
            before=before,
            source=source,
            after=after,
        )


def fitting(count: Count) -> Tile | None:
    """The best tile that fills the lattice; none where its sides are odd."""
    return next((t for t in TILES if count[0] % t[0] == 0 and count[1] % t[1] == 0), None)


def _tile_wgsl(width: int, height: int) -> str:
    """The tile's size, what it holds of the layers on the way, and how a layer is added."""
    columns = range(width * height)
    fields = "".join(f"    v{k}: vec4f,\n" for k in columns)
    return "\n".join(
        [
            f"const SLAB = {SLAB}u;",
            f"const WIDTH = {width}u;",
            f"const HEIGHT = {height}u;",
            f"struct Tile {{\n{fields}}}",
            "struct Layer { below: Tile, here: Tile, above: Tile }",
            "fn layer_at(n: vec3u, c: StepCoefficients, w: Weights, base: u32, x: u32, y: u32)"
            " -> Layer {",
            "    var layer: Layer;",
            *_rows(width, height),
            *sums_wgsl(width, height),
            "    return layer;",
            "}",
            "fn store(at: vec2u, n: vec3u, index: u32, tile: Tile) {",
            *_stores(width, height),
            "}",
            added_wgsl(width * height),
        ]
    )


def _rows(width: int, height: int) -> list[str]:
    """`r{y}_{x}`: sums and differences along x of the tile's rows and their neighbours."""
    lines = []
    for y in range(height + 2):
        inside = {0: "y > 0u", height + 1: f"y + {height}u < n.y"}.get(y)
        at = {0: "(max(y, 1u) - 1u)"}.get(y, f"min(y + {y - 1}u, n.y - 1u)")
        gain = f"select(vec4f(0.0), c.gain, {inside})" if inside else "c.gain"
        lines += [f"    let g{y} = {gain};", f"    let b{y} = base + {at} * n.x;"]
        for x in range(width + 2):
            if x == 0:
                value = f"before[b{y} + max(x, 1u) - 1u] * select(0.0, 1.0, x > 0u)"
            elif x == width + 1:
                last = f"x + {width}u < n.x"
                value = f"before[b{y} + min(x + {width}u, n.x - 1u)] * select(0.0, 1.0, {last})"
            else:
                value = f"before[b{y} + x + {x - 1}u]"
            lines.append(f"    let v{y}_{x} = {value} * g{y};")
        lines += [
            f"    let r{y}_{x} = Row(v{y}_{x + 1}, v{y}_{x + 2} + v{y}_{x}, "
            f"v{y}_{x + 2} - v{y}_{x});"
            for x in range(width)
        ]
    return lines


def sums_wgsl(width: int, height: int) -> list[str]:
    """What a layer's rows `r{y}_{x}` send to three layers, into `layer`."""
    lines = []
    for k in range(width * height):
        y, x = divmod(k, width)
        lines.append(f"    let s{k} = sent(c, w, r{y}_{x}, r{y + 1}_{x}, r{y + 2}_{x});")
        lines += [f"    layer.{part}.v{k} = s{k}.{part};" for part in ("below", "here", "above")]
    return lines


def _stores(width: int, height: int) -> list[str]:
    lines = []
    for k in range(width * height):
        y, x = divmod(k, width)
        at = f"index + {y}u * n.x + {x}u"
        lines.append(f"    after[{at}] = source[{at}] + tile.v{k};")
    return lines


def added_wgsl(columns: int) -> str:
    """`added(a, b)`: two tiles' sum."""
    parts = ", ".join(f"a.v{k} + b.v{k}" for k in range(columns))
    return f"fn added(a: Tile, b: Tile) -> Tile {{ return Tile({parts}); }}"
