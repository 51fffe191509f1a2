//! use hop_grid

// Light may hop from here.
fn list(entry: u32) {
    let place = atomicAdd(&listed[0], 1u);
    atomicStore(&listed[1u + place], entry);
    if (place % GROUP == 0u && place / GROUP < MOST_GROUPS) {
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
    // Most shells around a lamp beside the medium are far from its box: nothing to sample.
    let centre = hop_point(n, vec3f(cell) + 0.5);
    let apart = distance(centre, clamp(centre, vec3f(0.0), params.extent));
    let is_far = grids[n].is_radial == 1u && apart > hop_path(n, cell.z);
    let samples = select(8u, 0u, is_far);
    for (var k = 0u; k < samples; k++) {
        let offset = vec3f(vec3u(k, k >> 1u, k >> 2u) & vec3u(1u)) * 0.5 + 0.25;
        let uvw = hop_point(n, vec3f(cell) + offset) / params.extent;
        if (all(uvw >= vec3f(0.0)) && all(uvw <= vec3f(1.0))) {
            sum += textureSampleLevel(fine, linear_clamp, uvw, 0.0).x;
            inside += 1u;
        }
    }
    // Around lamps, what is beyond the medium's box is told from what is empty.
    let is_beyond = inside == 0u && grids[n].is_radial == 1u;
    hop_rho[n * hops.capacity + id.x] = select(sum / 8.0, -1.0, is_beyond);
    if (!is_beyond || hops.is_paper == 1u) {
        list(n * hops.capacity + id.x);
    }
}
