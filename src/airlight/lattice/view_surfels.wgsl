//! use view_surfel
//! use blocker_sums

fn add(index: u32, units: i32) {
    if (units != 0) { atomicAdd(&sums[index], units); }
}

fn add_axis(first: u32, axis: u32, covered: f32, offset: f32, reflectance: vec3f) {
    let units = i32(round(abs(covered)));
    if (units == 0) {
        return;
    }
    let side = 2u * axis + select(1u, 0u, covered > 0.0);
    add(first + side, units);
    add(first + AXIS_COVER + axis, units);
    add(first + AXIS_MOMENT + axis, i32(round(f32(units) * offset)));
    let outward = select(-offset, offset, covered > 0.0);
    atomicMax(&sums[first + SIDE_BEHIND + side], behind_code(outward));
    let reflected = vec3i(round(f32(units) * reflectance));
    for (var channel = 0u; channel < 3u; channel++) {
        add(first + SIDE_REFLECTED + 3u * side + channel, reflected[channel]);
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let seen = view_surfel(id);
    if (seen.corner == NO_CORNER) {
        return;
    }
    let first = CORNER_VALUES * seen.corner;
    let covered = seen.normal * (seen.area * params.units);
    add_axis(first, 0u, covered.x, seen.offset.x, seen.reflectance);
    add_axis(first, 1u, covered.y, seen.offset.y, seen.reflectance);
    add_axis(first, 2u, covered.z, seen.offset.z, seen.reflectance);
}
