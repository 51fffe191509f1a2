// Whether light comes into a cell by a hop and goes back out: in walls it may go one way alone. The including pass binds
// `params` (FloodParams) and `face_visibility`, and has OPEN. Twin: maths.regions.
//! use cell_order
//! use entering_share

// The cell that hops along x, back along x, along y and so on come from; beyond the lattice it is none of its cells.
fn hop_from(cell: vec3u, hop: u32) -> vec3u {
    var beside = vec3i(cell);
    beside[hop / 2u] += select(1, -1, (hop & 1u) == 0u);
    return vec3u(beside);
}

fn open_both_ways(cell: vec3u, hop: u32) -> bool {
    let beside = hop_from(cell, hop);
    if (any(beside >= params.count)) {
        return false;
    }
    if (params.has_walls == 0u) {
        return true;
    }
    let there = entering_share(face_visibility[cell_in(params.count, cell)], hop);
    let back = entering_share(face_visibility[cell_in(params.count, beside)], hop ^ 1u);
    return min(there, back) > OPEN;
}
