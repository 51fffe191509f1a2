// One step over columns of 2 x 2 cells, marched along z. Cells beyond the lattice hold no light.
// `openness` packs, per destination cell, the open share of its six incoming hops as unorm8.

override IS_BLOCKED: bool = false;

const SLAB = 8u;

fn cell_index(x: u32, y: u32, z: u32, channel: u32) -> u32 {
    return ((channel * params.count.z + z) * params.count.y + y) * params.count.x + x;
}

// What cell (x, y, z) receives of its six neighbours.
fn gathered(
    cell: u32, west: vec4f, east: vec4f, south: vec4f, north: vec4f, below: vec4f, above: vec4f,
) -> vec4f {
    if (!IS_BLOCKED) {
        return hop_0(west) + hop_1(east) + hop_2(south) + hop_3(north) + hop_4(below)
            + hop_5(above);
    }
    let packed = openness[cell];
    let xy = unpack4x8unorm(packed.x);
    let z = unpack4x8unorm(packed.y);
    return xy.x * hop_0(west) + xy.y * hop_1(east) + xy.z * hop_2(south) + xy.w * hop_3(north)
        + z.x * hop_4(below) + z.y * hop_5(above);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let channel = id.z / params.slabs;
    let x = 2u * id.x;
    let y = 2u * id.y;
    let z_first = (id.z % params.slabs) * SLAB;
    let n = params.count;
    if (channel >= 3u || x >= n.x || y >= n.y || z_first >= n.z) {
        return;
    }
    let z_last = min(z_first + SLAB, n.z);
    // Neighbours beyond the border are read at a clamped place and weighted by zero.
    let west = select(0.0, 1.0, x > 0u);
    let east = select(0.0, 1.0, x + 2u < n.x);
    let south = select(0.0, 1.0, y > 0u);
    let north = select(0.0, 1.0, y + 2u < n.y);
    let xw = max(x, 1u) - 1u;
    let xe = min(x + 2u, n.x - 1u);
    let ys = max(y, 1u) - 1u;
    let yn = min(y + 2u, n.y - 1u);
    let layer = n.x * n.y;
    var base = cell_index(0u, 0u, z_first, channel);
    let c00 = y * n.x + x;
    let c10 = c00 + 1u;
    let c01 = c00 + n.x;
    let c11 = c01 + 1u;

    let under = select(0.0, 1.0, z_first > 0u);
    let under_base = select(base, base - layer, z_first > 0u);
    var below00 = under * before[under_base + c00];
    var below10 = under * before[under_base + c10];
    var below01 = under * before[under_base + c01];
    var below11 = under * before[under_base + c11];
    var here00 = before[base + c00];
    var here10 = before[base + c10];
    var here01 = before[base + c01];
    var here11 = before[base + c11];
    for (var z = z_first; z < z_last; z++) {
        let over = select(0.0, 1.0, z + 1u < n.z);
        let over_base = select(base, base + layer, z + 1u < n.z);
        let above00 = over * before[over_base + c00];
        let above10 = over * before[over_base + c10];
        let above01 = over * before[over_base + c01];
        let above11 = over * before[over_base + c11];
        let west0 = west * before[base + y * n.x + xw];
        let west1 = west * before[base + (y + 1u) * n.x + xw];
        let east0 = east * before[base + y * n.x + xe];
        let east1 = east * before[base + (y + 1u) * n.x + xe];
        let south0 = south * before[base + ys * n.x + x];
        let south1 = south * before[base + ys * n.x + x + 1u];
        let north0 = north * before[base + yn * n.x + x];
        let north1 = north * before[base + yn * n.x + x + 1u];
        let cell = z * layer;
        after[base + c00] = source[base + c00]
            + gathered(cell + c00, west0, here10, south0, here01, below00, above00);
        after[base + c10] = source[base + c10]
            + gathered(cell + c10, here00, east0, south1, here11, below10, above10);
        after[base + c01] = source[base + c01]
            + gathered(cell + c01, west1, here11, here00, north0, below01, above01);
        after[base + c11] = source[base + c11]
            + gathered(cell + c11, here01, east1, here10, north1, below11, above11);
        below00 = here00;
        below10 = here10;
        below01 = here01;
        below11 = here11;
        here00 = above00;
        here10 = above10;
        here01 = above01;
        here11 = above11;
        base += layer;
    }
}
