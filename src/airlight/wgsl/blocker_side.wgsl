//! use blocker_sums

// A surface that faces one side of an axis, added to what blocks around a corner. The including
// pass binds `sums`, atomic. `first`: the corner's first value; `units`: the covered share of a
// face; `offset`: cells from the corner along the axis.
fn add_side(first: u32, side: u32, units: i32, offset: f32, reflectance: vec3f) {
    atomicAdd(&sums[first + side], units);
    let outward = select(-offset, offset, (side & 1u) == 0u);
    atomicMax(&sums[first + SIDE_BEHIND + side], behind_code(outward));
    let reflected = vec3i(round(f32(units) * reflectance));
    for (var channel = 0u; channel < 3u; channel++) {
        atomicAdd(&sums[first + SIDE_REFLECTED + 3u * side + channel], reflected[channel]);
    }
}

// The same surface as one across an axis, whichever side it faces: how much it covers, and where.
fn add_axis(first: u32, axis: u32, units: i32, offset: f32) {
    atomicAdd(&sums[first + AXIS_COVER + axis], units);
    atomicAdd(&sums[first + AXIS_MOMENT + axis], i32(round(f32(units) * offset)));
}
