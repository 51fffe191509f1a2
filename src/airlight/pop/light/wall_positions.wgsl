// The first surface on the path from the middle of a cell to those of the next along x, y and z: its distance in
// cells, eight bits each; WALL_FREE where there is none. Behind those of all cells: the reflectances of the
// surfaces that either cell sees, five bits each. Then the same of what stands close outside the outer faces.
//! use medium_grid
//! use rays
//! use walls

// Rays are longer at both ends than the step between two centres, by this share of it: a surface right at a centre is
// met by either neighbour.
const WIDER = 1e-3;

override IS_WHOLE: bool = true;  // whether the medium ends at the border of the grid

fn reflectance_code(instance: u32) -> u32 {
    return min(u32(round(reflectances[instance] * REFLECTING_STEPS)), 31u);
}

// The reflectance before each outer face of the medium's own box: of a surface no farther than the middle of a cell
// beyond it would be.
fn reflecting_outside(cell: vec3u, origin: vec3f) -> u32 {
    var found = 0u;
    for (var face = 0u; face < 6u && IS_WHOLE; face++) {
        let axis = face / 2u;
        let side = face & 1u;
        if (cell[axis] != select(0u, params.count[axis] - 1u, side == 1u)) {
            continue;
        }
        let step = params.world_from_medium[axis].xyz * params.cell[axis] * select(-1.0, 1.0, side == 1u);
        let hit = nearest_hit(origin, step, 0.0, 1.0);
        if (hit.triangle != NO_HIT) {
            found |= reflectance_code(hit.instance) << (REFLECTING_BITS * face);
        }
    }
    return found;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // Rays from the middle of the cell to those of the next cells along x, y and z.
    let cell = cell_of(id.x);
    let origin = (params.world_from_medium * vec4f(cell_centre(cell), 1.0)).xyz;
    var found = 0u;
    var reflecting = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        var position = WALL_FREE;
        if (cell[axis] + 1u < params.count[axis]) {
            // A wall in the middle of a cell closes the faces on both sides of it.
            let step = params.world_from_medium[axis].xyz * params.cell[axis];
            let hit = nearest_hit(origin, step, -WIDER, 1.0 + WIDER);
            if (hit.triangle != NO_HIT) {
                position = u32(round(clamp(hit.t, 0.0, 1.0) * f32(WALL_FREE - 1u)));
                // The next cell sees the last of them.
                let last = nearest_hit(origin + step, -step, -WIDER, 1.0 + WIDER);
                let own = reflectance_code(hit.instance);
                let beyond = reflectance_code(select(last.instance, hit.instance, last.triangle == NO_HIT));
                reflecting |= (own | (beyond << REFLECTING_BITS)) << (2u * REFLECTING_BITS * axis);
            }
        }
        found |= position << (8u * axis);
    }
    positions[id.x] = found;
    positions[params.cells + id.x] = reflecting;
    positions[2u * params.cells + id.x] = reflecting_outside(cell, origin);
}
