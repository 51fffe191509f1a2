// Packs 0 and 1 of every cell (1 - b of Billeter2012 eq. 2): the open shares of the hops that its
// neighbours send it, by the number of the hop that goes to the neighbour.
//! use hops26
//! use packed_hops
//! use cell_order

// The open share of a neighbour's hop, as hops_leaving has packed it.
fn open_leaving(cell: vec3i, hop: u32) -> f32 {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(params.count))) {
        return 1.0;
    }
    let c = vec3u(cell);
    let index = cell_in(params.count, c);
    let word = packs[4u * index + 2u + hop / 16u][(hop / 4u) & 3u];
    return unpack4x8unorm(word)[hop & 3u];
}

// What a neighbour's pack says of its hop hither, which is the opposite one.
fn open_hop(at: vec3i, hop: u32) -> f32 {
    return open_leaving(at + hop_offset(hop), 26u - hop);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cell = cell_in(params.count, id);
    // The first half of what is packed for a cell; hops that leave it are in the second.
    let words = packed_hops(vec3i(id));
    packs[4u * cell] = vec4u(words[0], words[1], words[2], words[3]);
    packs[4u * cell + 1u] = vec4u(words[4], words[5], words[6], 0u);
}
