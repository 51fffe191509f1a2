// Paths through a lattice that end at walls. The including pass binds `lattice` and `face_visibility`.
//! use entering_share
//! use lattice_space
//! use cell_order

// Whether walls close the face that a hop crosses into a cell.
fn is_shut(cell: vec3i, hop: u32) -> bool {
    let c = vec3u(clamp(cell, vec3i(0), vec3i(lattice.count) - 1));
    let index = cell_in(lattice.count, c);
    return entering_share(face_visibility[index], hop) < 0.5;
}

// From lattice coordinates by an `offset` in cells, but not through walls.
fn moved_freely(start: vec3f, offset: vec3f) -> vec3f {
    let steps = ceil(length(offset));
    var at = start;
    for (var i = 0.0; i < steps; i += 1.0) {
        let next = at + offset / steps;
        let from_cell = vec3i(floor(at));
        // Beyond the lattice no walls are known.
        if (any(from_cell < vec3i(0)) || any(from_cell >= vec3i(lattice.count))) {
            return start + offset;
        }
        let to_cell = vec3i(floor(next));
        for (var axis = 0u; axis < 3u; axis++) {
            let step = to_cell[axis] - from_cell[axis];
            // Visibility is of the hops that enter a cell: + of a pair first.
            if (step != 0 && is_shut(to_cell, 2u * axis + select(1u, 0u, step > 0))) {
                return at;
            }
        }
        at = next;
    }
    return at;
}

// The world point of lattice coordinates. Beyond the lattice cells go on; within it walls stand where the warp has them.
fn world_point(coordinates: vec3f) -> vec3f {
    let cell = vec3u(clamp(vec3i(floor(coordinates)), vec3i(0), vec3i(lattice.count) - 1));
    return unwarped_point(lattice, cell, coordinates - vec3f(cell));
}
