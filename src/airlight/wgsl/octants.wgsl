// The eight parts of a cell and its eight corners, x first: bits 0, 1 and 2 of k say which half of x, y and z.

fn octant(k: u32) -> vec3u {
    return vec3u(k, k >> 1u, k >> 2u) & vec3u(1u);
}

// The middle of a part, as a share of the cell.
fn octant_middle(k: u32) -> vec3f {
    return 0.5 * vec3f(octant(k)) + 0.25;
}
