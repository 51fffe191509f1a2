"""The WGSL that marches columns of cells along z in lanes that share a row (gpu.lanes).

As lpv.columns, but cells are read and stored two at a time, and what stands beside a lane's columns
comes from the lanes beside it: only the rows before and after a tile are read anew.
"""

from __future__ import annotations

from ..gpu.lanes import LANES, Rows

_MARCH = """
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {{
    let n = params.count;
    let slabs = (n.z + {slab}u - 1u) / {slab}u;
    let channel = id.z / slabs;
    let z_first = (id.z % slabs) * {slab}u;
    let x = {width}u * id.x;
    if (x >= n.x || {height}u * id.y >= n.y || channel >= {channels}u) {{
        return;
    }}
    let lane = id.x % {lanes}u;
    let is_first = x == 0u;
    let is_last = x + {width}u >= n.x;
    // The last tiles are pushed back inside; what they share with others comes out the same.
    let y = min({height}u * id.y, n.y - {height}u);
    let z_last = min(z_first + {slab}u, n.z);
    let has_south = y > 0u;
    let has_north = y + {height}u < n.y;
    let to_south = select(0u, n.x, has_south);
    let to_north = n.x * select({height}u - 1u, {height}u, has_north);
    let layer = n.x * n.y;
    var base = ((channel * n.z + z_first) * n.y + y) * n.x;
    let under = select(base, base - layer, z_first > 0u);
{begin}
    var z = z_first;
    loop {{
        let over = select(base, base + layer, z + 1u < n.z);
{gather}
        base += layer;
        z++;
        if (z >= z_last) {{
            break;
        }}
    }}
}}
"""


def row_march(rows: Rows, slab: int, channels: int = 1) -> str:
    """`main` as columns.column_march, for tiles of `rows`.

    The including shader's `light_at(cell)` has two cells `a`, `b`, and its `put(cell, a, b)` stores
    them; it also has `lane_before`, `lane_after` and `only_if`.
    """
    width, height = rows.width, rows.height
    begin = [*_places(rows)]
    for j in range(height):
        begin += _loaded(rows, "var below", "under", j, f"{j}u * n.x", "z_first > 0u")
        begin += _loaded(rows, "var here", "base", j, f"{j}u * n.x", "")
    gather: list[str] = []
    for j in range(height):
        gather += _loaded(rows, "let above", "over", j, f"{j}u * n.x", "z + 1u < n.z")
        gather += _beside(rows, j)
    gather += _loaded(rows, "let south", "base", 0, "", "has_south", away=" - to_south")
    gather += _loaded(rows, "let north", "base", 0, "to_north", "has_north")
    for j in range(height):
        for k in range(width // 2):
            gather += _gathered(rows, j, k)
    for j in range(height):
        for i in range(width):
            gather += [f"below_{i}_{j} = here_{i}_{j};", f"here_{i}_{j} = above_{i}_{j};"]
    return _MARCH.format(
        width=width,
        height=height,
        slab=slab,
        channels=channels,
        lanes=LANES,
        begin=_lines(begin, 4),
        gather=_lines(gather, 8),
    )


def _places(rows: Rows) -> list[str]:
    """`x0`, `x1` ...: where the tile's pairs stand along x, and whether they are there."""
    lines = []
    for k in range(rows.width // 2):
        place = f"x + {2 * k}u" if k else "x"
        if rows.is_ragged and k:
            # A pair beyond the row is read at its end, and nothing.
            lines.append(f"let has_{k} = {place} < n.x;")
            place = f"min({place}, n.x - 2u)"
        lines.append(f"let x{k} = {place};")
    return lines


def _loaded(
    rows: Rows, name: str, base: str, j: int, offset: str, condition: str, away: str = ""
) -> list[str]:
    """`{name}_{i}_{j}`: a row of the tile."""
    lines = []
    stem = name.split()[-1]
    for k in range(rows.width // 2):
        at = f"{base} + {offset} + x{k}" if offset else f"{base}{away} + x{k}"
        lines.append(f"let {stem}_pair_{k}_{j} = light_at({at});")
        asked = [condition] if condition else []
        asked += [f"has_{k}"] if rows.is_ragged and k else []
        for i, part in enumerate("ab"):
            value = f"{stem}_pair_{k}_{j}.{part}"
            if asked:
                value = f"only_if({value}, {' && '.join(asked)})"
            lines.append(f"{name}_{2 * k + i}_{j} = {value};")
    return lines


def _beside(rows: Rows, j: int) -> list[str]:
    """`west_{j}`, `east_{j}`: the columns of the lanes before and after this one."""
    last = rows.width - 1
    lines = [
        f"var west_{j} = only_if(lane_before(here_{last}_{j}), !is_first);",
        f"var east_{j} = only_if(lane_after(here_0_{j}), !is_last);",
    ]
    if rows.is_whole:
        return lines
    row = f"base + {j}u * n.x + x"
    return [
        *lines,
        f"if (lane == 0u && !is_first) {{ west_{j} = light_at({row} - 2u).b; }}",
        f"if (lane == {LANES - 1}u && !is_last) {{",
        f"    east_{j} = light_at({row} + {rows.width}u).a;",
        "}",
    ]


def _gathered(rows: Rows, j: int, k: int) -> list[str]:
    """What the two cells of pair k in row j hold next."""
    results = []
    for i in (2 * k, 2 * k + 1):
        west = f"here_{i - 1}_{j}" if i else f"west_{j}"
        east = f"here_{i + 1}_{j}" if i + 1 < rows.width else f"east_{j}"
        south = f"here_{i}_{j - 1}" if j else f"south_{i}_0"
        north = f"here_{i}_{j + 1}" if j + 1 < rows.height else f"north_{i}_0"
        cell = f"base + {j}u * n.x + x{k} + {i % 2}u"
        results.append(
            f"gathered({cell}, here_{i}_{j}, {west}, {east}, {south}, {north}, "
            f"below_{i}_{j}, above_{i}_{j})"
        )
    put = f"put(base + {j}u * n.x + x{k}, {results[0]},\n        {results[1]});"
    return [f"if (has_{k}) {{ {put} }}" if rows.is_ragged and k else put]


def _lines(lines: list[str], indent: int) -> str:
    return "\n".join(" " * indent + line for line in lines)
