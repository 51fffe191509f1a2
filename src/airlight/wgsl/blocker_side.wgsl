//! use blocker_sums
//! use obliqueness

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

// A surface of unit normal n that covers so much of a face if it lies in it, as a plane aslant to the cells. `offset`:
// cells from the corner.
fn add_oblique(first: u32, n: vec3f, units: f32, offset: vec3f) {
    if (obliqueness(n, OBLIQUE) < 1.0) {
        return;
    }
    let sizes = abs(n);
    let most = max(sizes.x, max(sizes.y, sizes.z));
    let axis = select(select(2u, 1u, sizes.y == most), 0u, sizes.x == most);
    let side = 2u * axis + select(1u, 0u, n[axis] > 0.0);
    let at = first + PLANES + PLANE_VALUES * side;
    let normal = vec3i(round(units * n));
    for (var k = 0u; k < 3u; k++) {
        atomicAdd(&sums[at + k], normal[k]);
    }
    let along = dot(n, offset);
    atomicAdd(&sums[at + PLANE_MOMENT], i32(round(units * along)));
    atomicAdd(&sums[at + PLANE_SQUARE], i32(round(units * along * along)));
    atomicOr(&sums[first + PLANE_SIDES], i32(1u << side));
}
