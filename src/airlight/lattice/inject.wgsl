// Every texel of a reflective shadow map is a virtual point light, whose cosine lobe enters the cell
// half a cell in front of it (Kaplanyan2010 section 3.1; twin of the lobe: maths.sh.cosine_lobe).
// The including pass says what of a layer's light arrives at a point: light_arriving(layer, p).
//! use lattice_space
//! use lobes
//! use light_texel
//! needs fn light_arriving(layer: u32, p: vec3f) -> vec3f

// 0 for objects up to a size, 1 for those half as large again.
fn large_enough(size: f32, least: f32) -> f32 {
    return select(smoothstep(least, 1.5 * least, size), 1.0, least <= 0.0);
}

// The share that counts of an object's light: small ones would flicker from cell to cell. What is
// too small for the next larger lattice fades out where that takes over.
fn object_share(size: f32, p: vec3f) -> f32 {
    if (size <= 0.0 && params.has_static == 0u) {
        return 1.0;
    }
    let beyond = large_enough(abs(size), params.next_least);
    let share = large_enough(abs(size), params.least);
    return share * select(mix(lattice_weight(lattice, p), 1.0, beyond), 1.0, beyond >= 1.0);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.resolution || id.y >= params.resolution || id.z >= params.layers) {
        return;
    }
    let texel = vec2i(id.xy);
    let power_density = textureLoad(flux, texel, id.z, 0).rgb;
    let d = textureLoad(depth, texel, id.z, 0);
    if (d >= 1.0 || all(power_density <= vec3f(0.0))) {
        return;
    }
    // The surface that the texel shows.
    let view = views[id.z];
    let centre = texel_centre(id.xy, params.resolution);
    let facing = textureLoad(normal, texel, id.z, 0);
    let n = lattice_from_world(lattice, normalize(facing.xyz));
    let p = texel_point(view, centre, d);
    // Its flux, half a cell before it, where it is not in the cell of the wall itself.
    let share = object_share(facing.w, p);
    if (share > 0.0) {
        let coordinates = warped_surface_coordinates(lattice, p, n) + 0.5 * n;
        let measure = share * texel_measure(view, centre, params.resolution);
        add_lobe(coordinates, n, light_arriving(id.z, p) * power_density * measure);
    }
}
