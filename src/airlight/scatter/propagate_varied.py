"""One step to 26 neighbours where the air differs from cell to cell.

A hop runs half in its source and half in its destination cell; what is lost on it, and the length
travelled, is shared between the two linearly (maths.lattice26.half_linear_step is the NumPy truth,
with maths.lattice26_walls.bounced among walls). Equals `propagate` in constant air.
differs: Billeter2012 knows homogeneous media only.

The plain kernel works out all 27 cells' air for each cell; on CPU adapters lanes share rows
(propagate_varied_rows), and each cell's is worked out where it is read.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.lanes import has_row_lanes
from ..gpu.layout import Struct, f32, vec3u
from ..gpu.memory import Buffer
from ..gpu.slots import storage, uniform
from ..maths.lattice26 import RHO, hops
from .coefficients import CHANNELS
from .hop_wgsl import (
    COUNT,
    constants,
    kind,
    leaving_shares,
    literal,
    normal,
    offset_vector,
    offsets,
    opened,
    signed_sum,
)
from .propagate import Count
from .propagate_varied_rows import VariedRows, is_whole_row, takes_rows


class VariedParams(Struct):
    """The lattice's size."""

    count = vec3u("cells")
    cell = f32("m")
    straight = f32("net direction of what arrives, per 3 W")
    deficit = f32("least reflectance of negative power: 1, or 0 for corrections of either sign")


class _Varied(ComputePass):
    slots = (
        uniform("params", VariedParams),
        storage("medium", "vec2f"),
        storage("before", "vec4f"),
        storage("source", "vec4f"),
        storage("after", "vec4f", "read_write"),
        storage("packs", "vec4u"),
    )
    workgroup = (32, 4, 2)
    file = "propagate_varied.wgsl"


class VariedStep:
    """Runs steps through a buffer of (sigma_s, sigma_t) m^-1 per channel and cell."""

    def __init__(self, gpu: Gpu, *, is_blocked: bool, has_rows: bool | None = None) -> None:
        """`has_rows` chooses lanes that share rows; by default where the driver has them."""
        self._gpu, self._is_blocked = gpu, is_blocked
        self._has_rows = has_row_lanes(gpu) if has_rows is None else has_rows
        self._cells: dict[bool, _Varied] = {}
        self._rows: dict[tuple[bool, bool], VariedRows] = {}

    def encode(
        self,
        commands: Commands,
        count: Count,
        cell_size_m: float,
        medium: Buffer,
        *,
        is_track: bool,
        before: Buffer,
        source: Buffer,
        after: Buffer,
        packs: Buffer,
        keeps_deficits: bool = True,
        kept: float = RHO**2,
    ) -> None:
        """after = source + K before; K gives the track where `is_track`, else the next state.

        `kept` as in step_rows.
        """
        nx, ny, nz = count
        params = VariedParams.of(
            count=count, cell=cell_size_m, straight=kept / RHO, deficit=float(keeps_deficits)
        )
        values = {
            "params": params,
            "medium": medium,
            "before": before,
            "source": source,
            "after": after,
            "packs": packs,
        }
        if self._has_rows and takes_rows(count):
            self._row_kernel(count, is_track).encode(commands, count, **values)
        else:
            self._cell_kernel(is_track).dispatch(commands, (nx, ny, CHANNELS * nz), **values)

    def _cell_kernel(self, is_track: bool) -> _Varied:
        if is_track not in self._cells:
            rules = _OUTPUTS["track" if is_track else "move"]
            text = f"{constants()}\n{_gathered(rules, self._is_blocked)}"
            self._cells[is_track] = _Varied(self._gpu, generated=text)
        return self._cells[is_track]

    def _row_kernel(self, count: Count, is_track: bool) -> VariedRows:
        # What takes long rows takes short ones, and is compiled already where those come later.
        is_whole = is_whole_row(count) and (False, is_track) not in self._rows
        if (is_whole, is_track) not in self._rows:
            self._rows[is_whole, is_track] = VariedRows(
                self._gpu,
                VariedParams,
                is_track=is_track,
                is_blocked=self._is_blocked,
                is_whole=is_whole,
            )
        return self._rows[is_whole, is_track]


# What one hop of unit power gives, by what is asked: the half hop in the cell the power starts in
# (`s`: q, u, w of its air) and in the other (`d`); see `half_hop` in the shader.
_OUTPUTS = {
    "move": {
        "arriving": "far.s * {f}.y + own.s * {f}.x * (2.0 * {o}.y + {o}.z) + {f}.x * {o}.x",
        "arriving_direct": "3.0 * params.straight * {f}.x * {o}.x",
        "kept": "own.s * ({o}.y + 2.0 * {o}.z) + far.s * {o}.x * {f}.z",
        "kept_direct": "0.0",
        "stopped": "own.s * {way}",
        "stopped_direct": "0.0",
        "returned": "{o}.x * (own.s * {way} + {o}.x)",
        "returned_direct": "RETURNED * {o}.x * {o}.x",
    },
    "track": {
        "arriving": "{f}.y + {f}.x * (2.0 * {o}.y + {o}.z)",
        "arriving_direct": "RHO * gain",
        "kept": "{o}.y + 2.0 * {o}.z + {o}.x * {f}.z",
        "kept_direct": "RHO * keep",
        "stopped": "{way}",
        "stopped_direct": "RHO * {way}",
        "returned": "{o}.x * {way}",
        "returned_direct": "REFLECTED_TRACK * {o}.x * {way}",
    },
}


def _gathered(rules: dict[str, str], is_blocked: bool) -> str:
    """`gathered(own, at, channel, p)`: the kernel's sum over neighbours, unrolled."""
    lines = [
        "fn gathered(own: Cell, at: vec3i, channel: u32, p: u32) -> vec4f {",
        "    var even = 0.0;",
        "    var direct = vec3f(0.0);",
        *(f"    let h{k} = half_hop(own.t, LENGTH_{k});" for k in range(3)),
    ]
    if is_blocked:
        lines += [
            f"    let {name} = packs[p + {k}u];"
            for k, name in enumerate(("in0", "in1", "out0", "out1"))
        ]
        lines += ["    let white = unpack4x8unorm(out1.w)[channel];", *leaving_shares()]
    for j in range(COUNT):
        lines += ["    {", *_visit(j, rules, is_blocked), "    }"]
    return "\n".join([*lines, "    return vec4f(even, direct);", "}"])


def _visit(j: int, rules: dict[str, str], is_blocked: bool) -> list[str]:
    """What neighbour j sends, and what the cell keeps of the hop it sends there."""
    k = kind(j)
    names = {"o": f"h{k}", "f": "far_hop", "way": f"(2.0 * (h{k}.y + h{k}.z))"}
    rule = {name: text.format(**names) for name, text in rules.items()}
    x, y, z = offsets()[j]
    scale = literal(RHO / float(hops().lengths[j]))
    along = f"({offset_vector(j)} / LENGTH_{k})"
    share = f" * {opened('in', j)}" if is_blocked else ""
    mine = f" * o{j}" if is_blocked else ""
    lines = [
        f"let far = cell_at(at + vec3i({x}, {y}, {z}), channel);",
        f"let far_hop = half_hop(far.t, LENGTH_{k});",
        f"let came = WEIGHT_{k} * (far.v.x + {scale} * ({signed_sum('far.v', j, -1)})){share};",
        f"let gain = {rule['arriving']};",
        "even += came * gain;",
        f"direct -= came * ({rule['arriving_direct']}) * {along};",
        f"let sent = WEIGHT_{k} * (own.v.x + {scale} * ({signed_sum('own.v', j)}));",
        f"let keep = {rule['kept']};",
        f"even += sent{mine} * keep;",
        f"direct += sent{mine} * ({rule['kept_direct']}) * {along};",
    ]
    if is_blocked:
        lines += [
            f"let shut = sent * (1.0 - o{j});",
            "let back = shut * select(white, max(white, params.deficit), sent < 0.0);",
            f"even += shut * ({rule['stopped']}) + back * ({rule['returned']});",
            f"direct += shut * ({rule['stopped_direct']}) * {along}"
            f" + back * ({rule['returned_direct']}) * {normal(j)};",
        ]
    return [f"        {line}" for line in lines]
