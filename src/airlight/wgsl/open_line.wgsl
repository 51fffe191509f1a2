// Straight lines through a lattice's blockers. The including pass binds `lattice` (LatticeParams),
// lattice_visibility_a, lattice_visibility_b and lattice_walls (lattice/blockers.py).
//! use lattice_space

const MOST_CELLS = 128u;

// The open share of a cell's face across an axis, in both directions.
fn open_face_of(grid: LatticeParams, cell: vec3i, axis: u32, is_high: bool) -> f32 {
    let texel = lattice_texel(grid, cell);
    let side = u32(is_high);
    if (axis == 2u) {
        return textureLoad(lattice_visibility_b, texel, 0)[side];
    }
    return textureLoad(lattice_visibility_a, texel, 0)[2u * axis + side];
}

fn open_face(cell: vec3i, axis: u32, is_high: bool) -> f32 {
    return open_face_of(lattice, cell, axis, is_high);
}

// The transmittance of the faces along a straight line between two points, in lattice coordinates.
fn open_line(begin: vec3f, end: vec3f) -> f32 {
    return open_line_of(lattice, begin, end);
}

fn open_line_of(grid: LatticeParams, begin: vec3f, end: vec3f) -> f32 {
    // From face to face (a digital differential analyser): `next` is the share of the line to each axis' next face.
    let last = vec3i(grid.count) - 1;
    var cell = clamp(vec3i(floor(begin)), vec3i(0), last);
    let target_cell = clamp(vec3i(floor(end)), vec3i(0), last);
    let line = end - begin;
    let is_up = line > vec3f(0.0);
    let per_cell = 1.0 / max(abs(line), vec3f(1e-9));
    var next = (select(vec3f(cell) - begin, vec3f(cell) + 1.0 - begin, is_up))
        * select(-per_cell, per_cell, is_up);
    // The product of the faces' transmittances on the line, while anything is left.
    var open = 1.0;
    for (var k = 0u; k < MOST_CELLS && any(cell != target_cell) && open > 0.01; k++) {
        var axis = select(0u, 1u, next.y < next.x);
        axis = select(axis, 2u, next.z < next[axis]);
        if (next[axis] > 1.0) {
            break;
        }
        open *= open_face_of(grid, cell, axis, is_up[axis]);
        cell[axis] = clamp(cell[axis] + select(-1, 1, is_up[axis]), 0, last[axis]);
        next[axis] += per_cell[axis];
    }
    return open;
}
