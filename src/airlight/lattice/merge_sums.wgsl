// The maximum of what several buffers cover. What hangs on a share (its reflectance, its moment)
// comes from the buffer that covers more.
//! use blocker_sums

fn merged_units(value: i32) -> i32 {
    return i32(round(f32(value) / params.finer));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.corners) {
        return;
    }
    let first = CORNER_VALUES * id.x;
    // Each side's share with its reflectance, and the backmost surface of all.
    for (var side = 0u; side < 6u; side++) {
        let covered = merged_units(sums[first + side]);
        if (covered > merged[first + side]) {
            merged[first + side] = covered;
            let at = first + SIDE_REFLECTED + 3u * side;
            for (var k = 0u; k < 3u; k++) {
                merged[at + k] = merged_units(sums[at + k]);
            }
        }
        let behind = first + SIDE_BEHIND + side;
        merged[behind] = max(merged[behind], sums[behind]);
    }
    // Each axis' share with its moment.
    for (var axis = 0u; axis < 3u; axis++) {
        let at = first + AXIS_COVER + axis;
        let covered = merged_units(sums[at]);
        if (covered > merged[at]) {
            merged[at] = covered;
            merged[first + AXIS_MOMENT + axis] = merged_units(sums[first + AXIS_MOMENT + axis]);
        }
    }
    // Oblique planes of each side, by the one that covers more.
    for (var side = 0u; side < 6u; side++) {
        let at = first + PLANES + PLANE_VALUES * side;
        if (abs(merged_units(sums[at + side / 2u])) > abs(merged[at + side / 2u])) {
            for (var k = 0u; k < PLANE_VALUES; k++) {
                merged[at + k] = merged_units(sums[at + k]);
            }
        }
    }
    merged[first + PLANE_SIDES] |= sums[first + PLANE_SIDES];
    // Empty for the next buffer.
    for (var k = 0u; k < CORNER_VALUES; k++) {
        sums[first + k] = 0;
    }
}
