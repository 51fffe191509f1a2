"""Two steps to 26 neighbours at once, where lanes see one another.

As propagate_rows. Each invocation holds the state between the two steps, for its tile and the rows
beside it, two layers behind what it reads: half as much is read and stored, for a quarter more
arithmetic. Of the processor time of two steps it takes .77 in tiles of 8 rows.
"""

from __future__ import annotations

from ..gpu.device import Gpu
from ..gpu.lanes import Rows
from .propagate_rows import (
    Count,
    RowPass,
    beside,
    height_for,
    held,
    opening,
    read,
    row_place,
    sent,
    stored,
    summed,
)

_HEIGHTS = {8: 0.82, 6: 0.82, 4: 0.89}
"""Rows of a tile, and what a cell and step cost in it, over single steps in tiles of 8 rows."""


def pairs_for(count: Count) -> Rows | None:
    """How a lattice is cut for two steps at once; none where lanes do not hold a whole row."""
    nx, ny, _ = count
    rows = Rows.of(nx, height_for(nx, ny, _HEIGHTS))
    return rows if nx % 2 == 0 and rows.is_whole else None


class OpenPairs(RowPass):
    """after = K K before (+ source), without walls, on lattices whose rows lanes hold."""

    def __init__(self, gpu: Gpu, rows: Rows, *, is_added: bool) -> None:
        super().__init__(gpu, rows, _march(rows, is_added))


def _march(rows: Rows, is_added: bool) -> list[str]:
    """`march`: as propagate_rows', for rows y - 2 .. of what is read and y - 1 .. between steps.

    Layers count from two below the slab. `a`, `d` are to the state between what `e`, `t` are to
    the one after: it is complete one layer below the one that is read.
    """
    width, height = rows.width, rows.height
    lines = [
        *opening(rows),
        *(line for name in "et" for line in held(name, width * height)),
        *(line for name in "ad" for line in held(name, width * (height + 2))),
        "    var k = select(0u, 2u, at.z == 0u);",
        "    let end = z_last + 4u - at.z;",
        "    loop {",
        "        let z = at.z + k - 2u;",
        "        let base = first + min(z, n.z - 1u) * n.x * n.y;",
        "        let index = first + ((z - 2u) * n.y + at.y) * n.x + at.x;",
        "        let has_layer = z < n.z;",
        "        let is_between = z >= 1u && z <= n.z;",
    ]
    for y in range(height + 4):
        lines += [*read(rows, y, y - 2, "has_layer"), *summed(rows, "v", "r", y)]
        lines += _between(rows, y - 2) if y >= 2 else []
        lines += _after(rows, y - 4, is_added) if y >= 4 else []
    return [
        *lines,
        "        k++;",
        "        if (k >= end) {",
        "            break;",
        "        }",
        "    }",
        "}",
    ]


def _between(rows: Rows, y: int) -> list[str]:
    """`m{y}_{x}`: row y of the state between the steps, dark beyond the lattice; its sums `q`."""
    width = rows.width
    lines = [
        *sent(rows, "s", "r", y),
        f"    let h{y} = is_between && {row_place(y - 1)[0]};",
    ]
    for x in range(width):
        k, part, there = width * y + x, f"s{y}_{x}", f"h{y}"
        if rows.is_ragged and x >= 2:
            there = f"h{y} && at.x + {x // 2 * 2}u < n.x"
        lines += [
            f"    let m{y}_{x + 1} = select(vec4f(0.0), a{k} + {part}.below, {there});",
            f"    a{k} = d{k} + {part}.here; d{k} = {part}.above;",
        ]
    return [*lines, *beside(rows, "m", y), *summed(rows, "m", "q", y)]


def _after(rows: Rows, y: int, is_added: bool) -> list[str]:
    """Row y of the state after both, stored once its layer is complete."""
    names = [(f"{rows.width * y + x}", f"u{y}_{x}") for x in range(rows.width)]
    whole = [f"e{k} + {part}.below" for k, part in names]
    return [
        *sent(rows, "u", "q", y),
        *stored(rows, y, whole, "k >= 4u", is_added),
        *(f"    e{k} = t{k} + {part}.here; t{k} = {part}.above;" for k, part in names),
    ]
