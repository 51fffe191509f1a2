// Where the walls around a cell end what else ends there: in the corner of a room each of three walls reaches as far as
// the others only.
//! use face_sums

const FLAT = vec2f(0.05, 0.15);    // cells from where a wall's area is in the mean to where it is
const ENDS = vec2f(0.1, 0.25);     // of a face: in corners of rooms a quarter is a wall, at which others end

// Of what counts around the corners at a cell's low end of an axis, and at its high end, the part before the wall there
// that faces into the cell.
fn before_ends(cell: vec3u, axis: u32) -> vec2f {
    var before = vec2f(1.0);
    for (var side = 0u; side < 2u; side++) {
        // Hop 2 axis ends at the high one. The wall is the backmost of what faces the hop.
        let hop = 2u * axis + side;
        let f = face_of(cell, hop);
        let outward = clamp(backmost(f, hop ^ 1u), -LARGEST_SHIFT, LARGEST_SHIFT);
        // An oblique surface, or several behind one another, end nothing at one place.
        let mean = on_face(f, AXIS_MOMENT + axis) / max(on_face(f, AXIS_COVER + axis), 1e-6);
        let off = abs(select(-mean, mean, side == 1u) - outward);
        let is_wall = smoothstep(ENDS.x, ENDS.y, on_face(f, hop ^ 1u)) * (1.0 - smoothstep(FLAT.x, FLAT.y, off));
        before[1u - side] = mix(1.0, 0.5 - outward, is_wall);
    }
    return before;
}

// For each cell the low and the high end of x, y and z, as unorm8.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let xy = vec4f(before_ends(id, 0u), before_ends(id, 1u));
    let z = vec4f(before_ends(id, 2u), 0.0, 0.0);
    ends[cell_in(params.count, id)] = vec2u(pack4x8unorm(xy), pack4x8unorm(z));
}
