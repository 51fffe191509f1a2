// The light of two cells along x in one channel; their place counts channel after channel.
//! use cell_pairs

override IS_ADDED: bool = false;    // to `added`

fn light_at(cell: u32) -> CellPair {
    return cell_pair(before[cell >> 1u]);
}

fn put(cell: u32, a: vec4f, b: vec4f) {
    var light = CellPair(a, b);
    if (IS_ADDED) {
        let more = cell_pair(added[cell >> 1u]);
        light = CellPair(a + more.a, b + more.b);
    }
    after[cell >> 1u] = cell_pair_bits(light.a, light.b);
}

fn lane_before(v: vec4f) -> vec4f {
    return subgroupShuffleUp(v, 1u);
}

fn lane_after(v: vec4f) -> vec4f {
    return subgroupShuffleDown(v, 1u);
}

// Nothing instead of `v` where it is not there: what lanes without work hold may be no number.
fn only_if(v: vec4f, is_there: bool) -> vec4f {
    return select(vec4f(0.0), v, is_there);
}
