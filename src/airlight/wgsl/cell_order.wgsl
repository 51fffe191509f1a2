// Where a cell, or a corner, of a lattice or of a medium's grid lies in buffers: x fastest, then y, then z.

fn cell_in(count: vec3u, cell: vec3u) -> u32 {
    return (cell.z * count.y + cell.y) * count.x + cell.x;
}

// Its inverse.
fn cell_at_index(count: vec3u, index: u32) -> vec3u {
    return vec3u(index % count.x, index / count.x % count.y, index / (count.x * count.y));
}
