// Which of a cell's six faces surfaces close, whether any of a face near it, and where; see wgsl/walls.wgsl.
//! use medium_grid
//! use walls

const AROUND = 2;   // cells: as far as splines read

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // Its own upper faces, and the upper faces of those below it.
    let cell = cell_of(id.x);
    let own = positions[id.x];
    var found = own << WALL_POSITIONS;
    for (var axis = 0u; axis < 3u; axis++) {
        found |= select(0u, 2u, position_of(own, axis) != WALL_FREE) << (2u * axis);
        if (cell[axis] > 0u) {
            let below = positions[id.x - cell_stride(axis)];
            found |= select(0u, 1u, position_of(below, axis) != WALL_FREE) << (2u * axis);
        }
    }
    // The reflectances of its faces: the lower side of its upper faces, the upper side of those below it; or what
    // stands outside.
    var reflecting = positions[2u * params.cells + id.x];
    let above = positions[params.cells + id.x];
    for (var axis = 0u; axis < 3u; axis++) {
        let upper = (above >> (2u * REFLECTING_BITS * axis)) & 31u;
        var lower = 0u;
        if (cell[axis] > 0u) {
            lower = (positions[params.cells + id.x - cell_stride(axis)] >> (2u * REFLECTING_BITS * axis
                + REFLECTING_BITS)) & 31u;
        }
        reflecting |= (lower | (upper << REFLECTING_BITS)) << (2u * REFLECTING_BITS * axis);
    }
    // Whether anything is closed around it.
    let low = vec3u(max(vec3i(cell) - AROUND, vec3i(0)));
    let high = min(cell + u32(AROUND), params.count - 1u);
    var is_near = false;
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                is_near |= positions[cell_index(vec3u(x, y, z))] != ALL_FREE;
            }
        }
    }
    walls[2u * id.x] = found | select(0u, WALLS_NEAR, is_near);
    walls[2u * id.x + 1u] = reflecting;
}
