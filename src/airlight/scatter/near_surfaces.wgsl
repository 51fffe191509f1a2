// Which cells surfaces read: those that have surfels around a corner of theirs or of a neighbour's.
//! use blocker_sums
//! use cell_order

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    // Sums of surfels lie at corners, of which there is one more than cells along each axis.
    let n = params.count + 1u;
    let low = max(id, vec3u(1u)) - 1u;
    let high = min(id + 2u, params.count);
    var is_near = 0u;
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x && is_near == 0u; x++) {
                let first = CORNER_VALUES * cell_in(n, vec3u(x, y, z)) + AXIS_COVER;
                is_near = u32((sums[first] | sums[first + 1u] | sums[first + 2u]) != 0);
            }
        }
    }
    near[cell_in(params.count, id)] = is_near;
}
