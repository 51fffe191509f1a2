// The residuum around a local light, whose cells are smaller than the medium's where it matters,
// added to the medium's cells in fixed point.
//! use hop_grid
//! use octants
//! use cell_order

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    // A cell of a grid of shells.
    let n = hops.first_local + id.y;
    if (n >= hops.grids || id.x >= hop_cells(n) || grids[n].is_radial == 0u) {
        return;
    }
    // Light that left the medium is lost.
    let is_inside = hop_rho[n * hops.capacity + id.x] > 0.0;
    let power = select(0.0, 1.0, is_inside) * gathered[3u * (n * hops.capacity + id.x) + 1u].xyz * grids[0].fixed_scale;
    if (all(power <= vec3f(0.0))) {
        return;
    }
    // Eight cells share it, trilinear.
    let point = hop_point(n, vec3f(hop_cell(n, id.x)) + 0.5);
    let top = vec3f(params.count) - 1.0;
    let at = clamp(point / params.cell - 0.5, vec3f(0.0), top);
    let low = floor(at);
    let part = at - low;
    for (var k = 0u; k < 8u; k++) {
        let upper = octant(k);
        let share = select(1.0 - part, part, upper == vec3u(1u));
        let cell = vec3u(min(low + vec3f(upper), top));
        let index = cell_in(params.count, cell);
        let amount = share.x * share.y * share.z * power;
        for (var c = 0u; c < 3u; c++) {
            atomicAdd(&splatted[3u * index + c], i32(round(amount[c])));
        }
    }
}
