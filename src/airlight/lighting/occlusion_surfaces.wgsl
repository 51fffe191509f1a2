// The image as horizons sample it: depth, normal and light of a texel side by side, and on CPU
// adapters a quarter of the pixels, which stay in the caches.
//! use near_field_texel

override HAS_LIGHT: bool = false;    // what occludes shows its light in `lit`

const SAME_SURFACE = 0.1;       // depths that differ by less than this share

fn inverse_distance(pixel: vec2u) -> f32 {
    return params.depth_scale * textureLoad(depth, pixel, 0);
}

// The pixel that stands for a texel: where its block has an edge, the near and the far side in
// turn (as on a chessboard), so that both are there for reading it at full size.
fn chosen_pixel(texel: vec2u) -> vec2u {
    let first = texel * params.scale;
    let last = params.size - 1u;
    var nearest = vec3f(-1.0);
    var farthest = vec3f(1e30);
    var k = 0u;
    loop {
        let pixel = min(first + vec2u(k % params.scale, k / params.scale), last);
        let inverse = inverse_distance(pixel);
        if (inverse > nearest.x) { nearest = vec3f(inverse, vec2f(pixel)); }
        if (inverse < farthest.x) { farthest = vec3f(inverse, vec2f(pixel)); }
        k++;
        if (k >= params.scale * params.scale) { break; }
    }
    // One surface: the pixel in the middle.
    if (nearest.x - farthest.x <= SAME_SURFACE * nearest.x) {
        return min(first + params.scale / 2u, last);
    }
    return vec2u(select(nearest.yz, farthest.yz, ((texel.x + texel.y) & 1u) == 1u));
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4u {
    let texel = vec2u(position.xy);
    let pixel = chosen_pixel(texel);
    let inverse = inverse_distance(pixel);
    var surface = SurfaceTexel(inverse, pixel - texel * params.scale, vec3f(0.0, 0.0, 1.0), vec3f(0.0));
    // What the texel's pixel sees; where that is the background it blocks nothing.
    if (inverse > 0.0) {
        surface.normal = textureLoad(normal, pixel, 0).xyz;
        if (HAS_LIGHT) {
            surface.light = textureLoad(lit, pixel, 0).rgb;
        }
    }
    return packed_surface(surface);
}
