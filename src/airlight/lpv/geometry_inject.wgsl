// Surfels of a view into the sums around the lattice's corners, as two bands (Kaplanyan2010 section 3.2).
//! use view_surfel

fn add(index: u32, value: f32) {
    let units = i32(round(value * params.units));
    if (units != 0) { atomicAdd(&sums[index], units); }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let seen = view_surfel(id);
    if (seen.corner == NO_CORNER) {
        return;
    }
    let first = 5u * seen.corner;
    add(first, 0.25 * seen.area);
    add(first + 1u, 0.5 * seen.area * seen.normal.x);
    add(first + 2u, 0.5 * seen.area * seen.normal.y);
    add(first + 3u, 0.5 * seen.area * seen.normal.z);
    // One reflectance for all channels, as the paper has it.
    let grey = dot(seen.reflectance, vec3f(0.2126, 0.7152, 0.0722));
    add(first + 4u, 0.25 * seen.area * grey);
}
