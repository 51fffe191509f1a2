// One step over columns of 2 x 2 cells, marched along z. Cells beyond the lattice hold no light.
// `faces` is lattice.blockers.Blockers.faces.

override IS_BLOCKED: bool = false;
override IS_REFLECTING: bool = false;   // blocked light bounces
override IS_FIRST: bool = false;        // negative power into a closed face is dropped, not kept

const SLAB = 8u;
const BOUNCE_LOBE = 2.0;                // a cosine lobe off the face

fn cell_index(x: u32, y: u32, z: u32, channel: u32) -> u32 {
    return ((channel * params.count.z + z) * params.count.y + y) * params.count.x + x;
}

// What a face makes of the share p of a cell's power that goes to it. The two-band light of a
// stream is negative behind it: such power is handed back whole, so that energy does not grow.
fn returned(p: f32, face: u32, channel: u32) -> f32 {
    let shares = unpack4x8unorm(face);
    let reflected = select(0.0, shares[channel], IS_REFLECTING);
    return p * select(select(shares.w, 0.0, IS_FIRST), reflected, p > 0.0);
}

// Light that leaves towards closed faces comes back into its own cell.
fn bounced(v: vec4f, channel: u32, side: vec4u, rest: vec4u) -> vec4f {
    let even = HOP_EVEN * v.x;
    let along = HOP_DIRECT * v.yzw;
    let plus = vec3f(returned(even + along.x, side.x, channel),
        returned(even + along.y, side.z, channel), returned(even + along.z, rest.x, channel));
    let minus = vec3f(returned(even - along.x, side.y, channel),
        returned(even - along.y, side.w, channel), returned(even - along.z, rest.y, channel));
    return vec4f(dot(plus + minus, vec3f(1.0)), BOUNCE_LOBE * (minus - plus));
}

// What cell (x, y, z) receives of its six neighbours.
fn gathered(
    cell: u32, channel: u32, here: vec4f, west: vec4f, east: vec4f, south: vec4f, north: vec4f, below: vec4f, above: vec4f,
) -> vec4f {
    if (!IS_BLOCKED) {
        return hop_0(west) + hop_1(east) + hop_2(south) + hop_3(north) + hop_4(below)
            + hop_5(above);
    }
    let side = faces[2u * cell];
    let rest = faces[2u * cell + 1u];
    let xy = unpack4x8unorm(rest.z);
    let z = unpack4x8unorm(rest.w);
    return bounced(here, channel, side, rest) + xy.x * hop_0(west) + xy.y * hop_1(east) + xy.z * hop_2(south) + xy.w * hop_3(north)
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
            + gathered(cell + c00, channel, here00, west0, here10, south0, here01, below00, above00);
        after[base + c10] = source[base + c10]
            + gathered(cell + c10, channel, here10, here00, east0, south1, here11, below10, above10);
        after[base + c01] = source[base + c01]
            + gathered(cell + c01, channel, here01, west1, here11, here00, north0, below01, above01);
        after[base + c11] = source[base + c11]
            + gathered(cell + c11, channel, here11, here01, east1, here10, north1, below11, above11);
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
