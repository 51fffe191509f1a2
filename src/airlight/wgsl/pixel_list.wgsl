// Pixels that cannot be made of a reduced image's texels, listed to be redrawn, with how many
// groups they fill. The including pass binds pixel_list_slots (media/pixel_list.py) and `redrawn`.
//! use packed_pixel

// Texels whose depth counts for less are another surface's.
const SAME_DEPTH = 0.2;
const MOST_GROUPS = 65535u;

// Whether texels of the pixel's own depth, of colours `least` to `most`, differ; or there is none.
fn is_redrawn(least: vec3f, most: vec3f, contrast: f32) -> bool {
    return contrast <= 0.0 || least.x > 1e38 || any(most - least > contrast * most);
}

// `beside` is added to what is drawn.
fn list_pixel(pixel: vec2u, beside: vec3f, group: u32) {
    let at = atomicAdd(&found[0], 1u);
    chosen[at] = vec4u(bitcast<vec3u>(beside), packed_pixel(pixel));
    atomicMax(&groups[0], min(at / group + 1u, MOST_GROUPS));
}
