"""One step of light to its six face neighbours: the kernel, and how lattices are cut for it.

GPUs take a cell per invocation. Software drivers load lane by lane, so loads are what a step costs
there: an invocation marches a tile of columns along z (lpv.columns) and, where eight invocations
see one another as lanes of a row, has half of what is beside it from them, and two cells in a load
(lpv.rows; of the tiles' processor time .55 among blockers, .6 without).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import LANES, Rows, has_row_lanes
from ..gpu.layout import Struct, f32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..maths.lattice6 import SPREAD_KEPT, Hop, Scheme, hops
from .columns import column_march
from .rows import row_march
from .storage import Format
from .sums import FLOAT

CHANNELS = 3
_CPU_TILE, _CPU_OPEN_TILE, _CPU_SLAB = (2, 4), (4, 4), 8  # measured best on a software driver
_ROW_TILE, _ROW_OPEN_TILE = (16, 8), (32, 16)
"""Cells of a tile and layers of a slab where lanes share rows. Tiles of 32 among blockers are as
quick but take three times as long to compile."""


class StepParams(Struct):
    """The lattice's size, and what the step does."""

    count = vec3u("cells")
    kept = f32("share of negative power into closed faces that is handed back")


class Step:
    """One step, in columns marched along z (lpv.columns), or in lanes that share rows (lpv.rows).

    Where faces block, an invocation has all channels, which share them; else one. With `is_added` a
    lattice is added to what the step makes.
    """

    def __init__(
        self,
        gpu: Gpu,
        count: tuple[int, int, int],
        scheme: Scheme,
        format: Format,
        *,
        is_blocked: bool,
        is_reflecting: bool,
        kept: float,
        is_added: bool = False,
    ) -> None:
        self._count = count
        kind = "light" if is_blocked else "open"
        channels = 1 if is_blocked else CHANNELS
        has_rows = format is FLOAT and count[0] % 2 == 0 and has_row_lanes(gpu)
        cut = _rows if has_rows else _tiles
        march, self._columns = cut(gpu, count, channels, is_blocked=is_blocked)
        text = format.wgsl + pair_functions(scheme, kept)
        text += _shader(f"{kind}_{'pairs' if has_rows else 'cells'}")
        if is_blocked:
            text += _shader(f"propagate_{scheme}")
        self.element = "vec4<u64>" if has_rows else format.element
        self._pass = _step_pass(
            gpu,
            self.element,
            "vec4<u64>" if has_rows else "vec4u",
            text + march,
            "propagate.wgsl" if is_blocked else "propagate_open.wgsl",
            {
                "IS_ADDED": float(is_added),
                **({"IS_REFLECTING": float(is_reflecting)} if is_blocked else {}),
            },
        )

    def encode(
        self,
        commands: Commands,
        before: Buffer,
        after: Buffer,
        faces: Buffer,
        kept: float = 1.0,
        added: Buffer | None = None,
    ) -> None:
        """after = M before + added. `kept`: what closed faces hand back of wrong-signed power."""
        self._pass.dispatch(
            commands,
            self._columns,
            params=StepParams.of(count=self._count, kept=kept),
            before=before,
            after=after,
            faces=faces,
            added=added or before,
        )


def _shader(name: str) -> str:
    return Path(__file__).with_name(f"{name}.wgsl").read_text()


def _tiles(
    gpu: Gpu, count: tuple[int, int, int], channels: int, *, is_blocked: bool
) -> tuple[str, tuple[int, int, int]]:
    """`main` of columns a lane, and how many there are."""
    width, height, slab = 1, 1, 1  # an invocation a cell
    if gpu.takes_cpu_paths:
        tile = _CPU_TILE if is_blocked else _CPU_OPEN_TILE
        width, height = (min(t, n) for t, n in zip(tile, count, strict=False))
        slab = _CPU_SLAB
    columns = (-(-count[0] // width), -(-count[1] // height), channels * -(-count[2] // slab))
    return column_march(width, height, slab, channels), columns


def _rows(
    gpu: Gpu, count: tuple[int, int, int], channels: int, *, is_blocked: bool
) -> tuple[str, tuple[int, int, int]]:
    """As _tiles, where lanes share a row."""
    cells, slab = _ROW_TILE if is_blocked else _ROW_OPEN_TILE
    rows = Rows.of(count[0], min(cells // Rows.of(count[0], 1).width, count[1]))
    columns = (
        -(-count[0] // rows.width),
        -(-count[1] // rows.height),
        channels * -(-count[2] // slab),
    )
    return row_march(rows, slab, channels), columns


def _step_pass(
    gpu: Gpu, element: str, face: str, text: str, wgsl: str, constants: dict[str, float]
) -> ComputePass:
    class PropagateStep(ComputePass):
        slots = (
            uniform("params", StepParams),
            storage("before", element),
            storage("after", element, "read_write"),
            storage("faces", face),
            storage("added", element),
        )
        # One run of lanes: a software driver runs groups without work, too.
        workgroup = (LANES, 1, 1) if gpu.takes_cpu_paths else (32, 8, 1)
        file = wgsl

    return PropagateStep(gpu, generated=text, constants=constants)


def pair_functions(scheme: Scheme, kept: float = SPREAD_KEPT) -> str:
    """WGSL of `along_x`, `along_y`, `along_z`: what two opposite neighbours' light adds.

    `kept`: of the spread of directions (`maths.lattice6.spread_kept`).

    Their first argument travels up the axis, the second down. Weights are literals: the software
    driver reads a table ten times slower.
    """
    matrix = hops(scheme)[0].matrix
    shares = "".join(
        f"const {name} = {_literal(value)};\n"
        for name, value in (("HOP_EVEN", matrix[0, 0]), ("HOP_DIRECT", matrix[0, 1]))
    )
    if scheme == "paper":
        pairs = [
            f"fn along_{axis}(up: vec4f, down: vec4f) -> vec4f {{ "
            f"return hop_{2 * k}(up) + hop_{2 * k + 1}(down); }}"
            for k, axis in enumerate("xyz")
        ]
        return shares + hop_functions(scheme) + "\n" + "\n".join(pairs) + "\n"
    return shares + "\n".join(_linear_pair(k, axis, kept) for k, axis in enumerate("xyz")) + "\n"


def _linear_pair(index: int, axis: str, kept: float) -> str:
    """Opposite hops differ in the sign of what couples a with b along the axis."""
    matrix, b = hops("centroid", kept)[2 * index].matrix, index + 1
    same = ", ".join(_literal(matrix[k, k]) for k in range(4))
    crossed = ["0.0"] * 4
    crossed[0] = f"odd.{'xyzw'[b]} * {_literal(matrix[0, b])}"
    crossed[b] = f"odd.x * {_literal(matrix[b, 0])}"
    return (
        f"fn along_{axis}(up: vec4f, down: vec4f) -> vec4f {{\n    let odd = up - down;\n"
        f"    return (up + down) * vec4f({same}) + vec4f({', '.join(crossed)});\n}}"
    )


def hop_functions(scheme: Scheme) -> str:
    """WGSL of `hop_0` .. `hop_5` (+x -x +y -y +z -z): what a neighbour's light adds."""
    text = _clamped_hop if scheme == "paper" else _linear_hop
    return "\n".join(text(index, hop) for index, hop in enumerate(hops(scheme)))


def _linear_hop(index: int, hop: Hop) -> str:
    rows = [_weighted(row) for row in hop.matrix]
    return f"fn hop_{index}(v: vec4f) -> vec4f {{ return vec4f({', '.join(rows)}); }}"


def _clamped_hop(index: int, hop: Hop) -> str:
    lines = [f"fn hop_{index}(v: vec4f) -> vec4f {{", "    var gained = vec4f(0.0);"]
    for face in hop.faces:
        along = _weighted([1.0, *face.receive])
        gain = ", ".join(_literal(g) for g in (1.0 / (4.0 * 3.141592653589793), *face.emit))
        power = f"{_literal(face.solid_angle_sr)} * max(0.0, {along})"
        lines.append(f"    gained += {power} * vec4f({gain});")
    return "\n".join([*lines, "    return gained;", "}"])


def _weighted(weights: Any) -> str:
    terms = [
        f"{_literal(w)} * v.{c}" for w, c in zip(weights, "xyzw", strict=True) if abs(w) > 1e-12
    ]
    return " + ".join(terms) or "0.0"


def _literal(value: float) -> str:
    return f"{value:.9e}".replace("e+00", "")
