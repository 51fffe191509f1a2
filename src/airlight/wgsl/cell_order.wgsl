// Where a cell of a lattice, or of a medium's grid, lies in buffers: x fastest, then y, then z.

fn cell_in(count: vec3u, cell: vec3u) -> u32 {
    return (cell.z * count.y + cell.y) * count.x + cell.x;
}
