// The medium's density in a cell of a grid, and the list of cells that light may propagate from.
//! use hop_grid
//! use octants

// List a cell, and dispatch one more group where it is the first of a group.
fn list_cell(entry: u32) {
    let index = atomicAdd(&listed[0], 1u);
    atomicStore(&listed[1u + index], entry);
    if (index % GROUP == 0u && index / GROUP < MOST_GROUPS) {
        atomicAdd(&groups[0], 1u);
        atomicStore(&groups[1], 1u);
        atomicStore(&groups[2], 1u);
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = id.y;
    if (n >= hops.grids || id.x >= hop_cells(n)) {
        return;
    }
    let cell = hop_cell(n, id.x);
    var sum = 0.0;
    var inside = 0u;
    // Most shells around a light beside the medium are far from its box, and need no samples.
    let centre = hop_point(n, vec3f(cell) + 0.5);
    let apart = distance(centre, clamp(centre, vec3f(0.0), params.extent));
    let is_far = grids[n].is_radial == 1u && apart > hop_path(n, cell.z);
    // The mean of eight samples.
    let samples = select(8u, 0u, is_far);
    for (var k = 0u; k < samples; k++) {
        let uvw = hop_point(n, vec3f(cell) + octant_middle(k)) / params.extent;
        if (all(uvw >= vec3f(0.0)) && all(uvw <= vec3f(1.0))) {
            sum += textureSampleLevel(fine, linear_clamp, uvw, 0.0).x;
            inside += 1u;
        }
    }
    // Around local lights a cell beyond the medium's box is marked by -1, to tell it from an empty
    // one.
    let is_beyond = inside == 0u && grids[n].is_radial == 1u;
    hop_rho[n * hops.capacity + id.x] = select(sum / 8.0, -1.0, is_beyond);
    if (!is_beyond || hops.is_paper == 1u) {
        list_cell(n * hops.capacity + id.x);
    }
}
