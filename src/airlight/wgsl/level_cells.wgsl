// Two lattices of a multigrid stack: a coarse cell holds 2 x 2 x 2 fine ones, fewer at the far border.
//! use octants

// Fine cell k of the eight in a coarse cell; it may lie beyond the lattice.
fn fine_cell(coarse: vec3u, k: u32) -> vec3u {
    return 2u * coarse + octant(k);
}
