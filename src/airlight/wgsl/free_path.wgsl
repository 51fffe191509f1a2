// Paths through a lattice past walls. The including pass binds `lattice` and `face_visibility`.
//! use entering_share
//! use lattice_space
//! use cell_order

// Visibility of the face that a hop crosses into a cell; beyond the lattice no walls are known.
fn visibility_of_face(cell: vec3i, hop: u32) -> f32 {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(lattice.count))) {
        return 1.0;
    }
    return entering_share(face_visibility[cell_in(lattice.count, vec3u(cell))], hop);
}

// Which part of walls lets by what goes from lattice coordinates by an `offset` in cells: face by face, in the order in which
// they are met, so that nothing passes where two walls meet.
fn passed_walls(start: vec3f, offset: vec3f) -> f32 {
    let steps = vec3i(sign(offset));
    // Of the whole way, the part between two faces of an axis, and that to the next one.
    let between = 1.0 / max(abs(offset), vec3f(1e-9));
    var next = between * select(1.0 - fract(start), fract(start), offset < vec3f(0.0));
    var cell = vec3i(floor(start));
    var passed = 1.0;
    loop {
        let part = min(next.x, min(next.y, next.z));
        if (!(part < 1.0) || passed <= 0.0) { break; }
        let axis = select(select(2u, 1u, next.y == part), 0u, next.x == part);
        let along = vec3u(axis) == vec3u(0u, 1u, 2u);
        cell += select(vec3i(0), steps, along);
        next += select(vec3f(0.0), between, along);
        // Visibility is of the hops that enter a cell: + of a pair first.
        passed *= visibility_of_face(cell, 2u * axis + select(1u, 0u, any(along & (steps > vec3i(0)))));
    }
    return passed;
}

// The world point of lattice coordinates. Beyond the lattice cells go on; within it walls stand where the warp has them.
fn world_point(coordinates: vec3f) -> vec3f {
    let cell = vec3u(clamp(vec3i(floor(coordinates)), vec3i(0), vec3i(lattice.count) - 1));
    return unwarped_point(lattice, cell, coordinates - vec3f(cell));
}
