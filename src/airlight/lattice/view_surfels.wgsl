// Surfels that a view shows, summed around the corners of the lattice; each faces the view with one side.
//! use view_surfel
//! use blocker_side

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let seen = view_surfel(id);
    if (seen.corner == NO_CORNER) {
        return;
    }
    // Its area across each axis covers a share of a face.
    let first = CORNER_VALUES * seen.corner;
    let covered = seen.normal * (seen.area * params.units);
    for (var axis = 0u; axis < 3u; axis++) {
        let units = i32(round(abs(covered[axis])));
        if (units != 0) {
            let side = 2u * axis + select(1u, 0u, covered[axis] > 0.0);
            add_side(first, side, units, seen.offset[axis], seen.reflectance);
            add_axis(first, axis, units, seen.offset[axis]);
        }
    }
    add_oblique(first, seen.normal, seen.area * params.units, seen.offset);
}
