// Cells of a medium's own grid. The including pass binds `params` (MediumParams).
//! use cell_order

fn cell_of(index: u32) -> vec3u {
    return cell_at_index(params.count, index);
}

fn cell_index(cell: vec3u) -> u32 {
    return cell_in(params.count, cell);
}

// How far apart in memory neighbours along an axis are.
fn cell_stride(axis: u32) -> u32 {
    let n = params.count;
    return select(select(n.x * n.y, n.x, axis == 1u), 1u, axis == 0u);
}

fn cell_centre(cell: vec3u) -> vec3f {
    return (vec3f(cell) + 0.5) * params.cell;
}
