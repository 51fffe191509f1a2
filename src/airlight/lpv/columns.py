"""The WGSL that marches columns of cells along z, for tiles of any width and height.

A column of width x height cells keeps its own cells and those below in registers, so that a cell
costs one load and a share of its tile's outline instead of six. Software drivers load lane by
lane, so there loads are what a step costs; GPUs have the parallelism for tiles of one cell.
"""

from __future__ import annotations

_MARCH = """
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {{
    let n = params.count;
    let slabs = (n.z + {slab}u - 1u) / {slab}u;
    let channel = id.z / slabs;
    let z_first = (id.z % slabs) * {slab}u;
    if ({width}u * id.x >= n.x || {height}u * id.y >= n.y || channel >= {channels}u) {{
        return;
    }}
    // The last tiles are pushed back inside; what they share with others comes out the same.
    let x = min({width}u * id.x, n.x - {width}u);
    let y = min({height}u * id.y, n.y - {height}u);
    let z_last = min(z_first + {slab}u, n.z);
    // Neighbours beyond the border are read at a clamped place and weighted by zero.
    let has_west = select(0.0, 1.0, x > 0u);
    let has_east = select(0.0, 1.0, x + {width}u < n.x);
    let has_south = select(0.0, 1.0, y > 0u);
    let has_north = select(0.0, 1.0, y + {height}u < n.y);
    let has_under = select(0.0, 1.0, z_first > 0u);
    let to_west = select(0u, 1u, x > 0u);
    let to_east = select({width}u - 1u, {width}u, x + {width}u < n.x);
    let to_south = select(0u, n.x, y > 0u);
    let to_north = n.x * select({height}u - 1u, {height}u, y + {height}u < n.y);
    let layer = n.x * n.y;
    var base = ((channel * n.z + z_first) * n.y + y) * n.x + x;
    let under = select(base, base - layer, z_first > 0u);
{begin}
    for (var z = z_first; z < z_last; z++) {{
        let has_over = select(0.0, 1.0, z + 1u < n.z);
        let over = select(base, base + layer, z + 1u < n.z);
{gather}
        base += layer;
    }}
}}
"""


def column_march(width: int, height: int, slab: int, channels: int = 1) -> str:
    """`main` over columns of width x height cells, `slab` layers each.

    `channels`: how many the slabs of a lattice follow one another for, one being all at once.

    The including shader has `light_at(cell)`, `gathered(cell, here, west, east, south, north,
    below, above)` and `put(cell, light)`, and `params.count`. Invocations: columns along x and y,
    slabs along z.
    """
    cells = [(i, j) for j in range(height) for i in range(width)]
    begin = [f"var below_{i}{j} = has_under * light_at(under + {_at(i, j)});" for i, j in cells]
    begin += [f"var here_{i}{j} = light_at(base + {_at(i, j)});" for i, j in cells]
    gather = [f"let above_{i}{j} = has_over * light_at(over + {_at(i, j)});" for i, j in cells]
    for j in range(height):
        gather.append(f"let west_{j} = has_west * light_at(base + {_at(0, j)} - to_west);")
        gather.append(f"let east_{j} = has_east * light_at(base + {_at(0, j)} + to_east);")
    for i in range(width):
        gather.append(f"let south_{i} = has_south * light_at(base + {i}u - to_south);")
        gather.append(f"let north_{i} = has_north * light_at(base + {i}u + to_north);")
    for i, j in cells:
        west = f"here_{i - 1}{j}" if i > 0 else f"west_{j}"
        east = f"here_{i + 1}{j}" if i < width - 1 else f"east_{j}"
        south = f"here_{i}{j - 1}" if j > 0 else f"south_{i}"
        north = f"here_{i}{j + 1}" if j < height - 1 else f"north_{i}"
        neighbours = f"{west}, {east}, {south}, {north}, below_{i}{j}, above_{i}{j}"
        cell = f"base + {_at(i, j)}"
        gather.append(f"put({cell}, gathered({cell}, here_{i}{j}, {neighbours}));")
    for i, j in cells:
        gather.append(f"below_{i}{j} = here_{i}{j};")
        gather.append(f"here_{i}{j} = above_{i}{j};")
    return _MARCH.format(
        width=width,
        height=height,
        slab=slab,
        channels=channels,
        begin=_lines(begin, 4),
        gather=_lines(gather, 8),
    )


def _at(i: int, j: int) -> str:
    """A cell of the tile, counted from its first."""
    return f"{j}u * n.x + {i}u" if j else f"{i}u"


def _lines(lines: list[str], indent: int) -> str:
    return "\n".join(" " * indent + line for line in lines)
