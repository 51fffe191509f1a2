// Whether the cell or one beside it, across edges and corners too, holds any medium: trilinear
// filtering of the emission reads no other cells.
//! use medium_grid

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    let cell = cell_of(id.x);
    let low = max(cell, vec3u(1u)) - 1u;
    let high = min(cell + 1u, params.count - 1u);
    // The largest density of all media among the 27 cells.
    var most = 0.0;
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                let beside = cell_index(vec3u(x, y, z));
                for (var m = 0u; m < MEDIA; m++) {
                    most = max(most, density[m * params.cells + beside]);
                }
            }
        }
    }
    reach[id.x] = select(0u, 1u, most > 0.0);
}
