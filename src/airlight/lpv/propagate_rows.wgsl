// propagate.wgsl for CPU adapters, whose invocations are lanes of a vector and whose cost is the number of loads.
// A lane has a pair of cells along x, one load of 64-bit integers, and its neighbours along x from the lanes beside
// it (gpu.lanes); it marches `layers` pairs along z and keeps those below and here in registers. Counts of cells along
// x are even.
//! use stencil6
//! use cell_pairs
//! needs fn stepped(s: Stencil, faces: Faces) -> mat3x4f

override IS_ADDED: bool = false;        // `added` to what is stored

struct Pair { a: mat3x4f, b: mat3x4f }

fn channels(red: CellPair, green: CellPair, blue: CellPair) -> Pair {
    return Pair(mat3x4f(red.a, green.a, blue.a), mat3x4f(red.b, green.b, blue.b));
}

fn faces_at(cell: u32) -> Faces {
    let both = cell_pair(faces[cell]);
    return Faces(bitcast<vec4u>(both.a), bitcast<vec4u>(both.b));
}

// Where the pair of cells from `cell` on stands, channel by channel.
fn pair_index(cell: u32) -> vec3u {
    let channel = params.count.x * params.count.y * params.count.z;
    return vec3u(cell, cell + channel, cell + 2u * channel) >> vec3u(1u);
}

fn pair_at(cell: u32) -> Pair {
    let at = pair_index(cell);
    return channels(cell_pair(before[at.x]), cell_pair(before[at.y]), cell_pair(before[at.z]));
}

fn store_pair(cell: u32, light: Pair) {
    let at = pair_index(cell);
    var state = light;
    if (IS_ADDED) {
        let more = channels(cell_pair(added[at.x]), cell_pair(added[at.y]), cell_pair(added[at.z]));
        state = Pair(state.a + more.a, state.b + more.b);
    }
    after[at.x] = cell_pair_bits(state.a[0], state.b[0]);
    after[at.y] = cell_pair_bits(state.a[1], state.b[1]);
    after[at.z] = cell_pair_bits(state.a[2], state.b[2]);
}

// Nothing instead of `v` where it is not there: what lanes without work hold may be no number.
fn only_if(v: mat3x4f, is_there: bool) -> mat3x4f {
    let none = vec4f(0.0);
    return mat3x4f(select(none, v[0], is_there), select(none, v[1], is_there), select(none, v[2], is_there));
}

fn pair_if(cell: u32, is_there: bool) -> Pair {
    let v = pair_at(cell);
    return Pair(only_if(v.a, is_there), only_if(v.b, is_there));
}

fn lane_before(v: mat3x4f) -> mat3x4f {
    return mat3x4f(subgroupShuffleUp(v[0], 1u), subgroupShuffleUp(v[1], 1u), subgroupShuffleUp(v[2], 1u));
}

fn lane_after(v: mat3x4f) -> mat3x4f {
    return mat3x4f(subgroupShuffleDown(v[0], 1u), subgroupShuffleDown(v[1], 1u), subgroupShuffleDown(v[2], 1u));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let x = 2u * id.x;
    let z_first = params.layers * id.z;
    if (x >= n.x || id.y >= n.y || z_first >= n.z) {
        return;
    }
    let z_last = min(z_first + params.layers, n.z);
    let layer = n.x * n.y;
    let is_first = x == 0u;
    let is_last = x + 2u >= n.x;
    let has_south = id.y > 0u;
    let has_north = id.y + 1u < n.y;

    // The pair below the first layer, and the first one.
    var cell = z_first * layer + id.y * n.x + x;
    var below = pair_if(select(cell, cell - layer, z_first > 0u), z_first > 0u);
    var here = pair_at(cell);
    var z = z_first;
    // The loop is tested at its end: CPU adapters run a body once more than a test before it passes.
    loop {
        // Neighbours along y and z are read; beyond the border the own pair, as nothing.
        let south = pair_if(select(cell, cell - n.x, has_south), has_south);
        let north = pair_if(select(cell, cell + n.x, has_north), has_north);
        let has_above = z + 1u < n.z;
        let above = pair_if(select(cell, cell + layer, has_above), has_above);
        // Neighbours along x come from the lanes beside this one, at the ends of a run of lanes from memory.
        var west = only_if(lane_before(here.b), !is_first);
        var east = only_if(lane_after(here.a), !is_last);
        if (id.x % WX == 0u && !is_first) {
            west = pair_at(cell - 2u).b;
        }
        if (id.x % WX == WX - 1u && !is_last) {
            east = pair_at(cell + 2u).a;
        }
        let a = Stencil(here.a, west, here.b, south.a, north.a, below.a, above.a);
        let b = Stencil(here.b, here.a, east, south.b, north.b, below.b, above.b);
        store_pair(cell, Pair(stepped(a, faces_at(cell)), stepped(b, faces_at(cell + 1u))));
        // On by a layer.
        below = here;
        here = above;
        cell += layer;
        z++;
        if (z >= z_last) { break; }
    }
}
