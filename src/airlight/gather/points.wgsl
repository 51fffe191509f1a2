// One surface point for each texel of a reduced image: that of one of its pixels, in each sample of the image
// another one.
//! use pixel_point
//! use sampling
//! use flat_normal
//! use near_field_lookup

override HAS_OCCLUSION: bool = false;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let size = vec2u(params.size);
    // Pixels of the texel are tried from another one on in each sample, until one shows a surface.
    let count = params.scale * params.scale;
    let first = u32(f32(count) * r2_noise(id.x, id.y, params.sample));
    var place = vec4f(0.0);
    var facing = vec4f(0.0);
    var plane = vec4f(0.0);
    var k = 0u;
    loop {
        let within = (first + k) % count;
        let pixel = id.xy * params.scale + vec2u(within % params.scale, within / params.scale);
        if (all(pixel < size)) {
            let d = textureLoad(depth, pixel, 0);
            if (d > 0.0) {
                let p = pixel_point(vec2f(pixel) + 0.5, d);
                place = vec4f(p, length(p - params.eye));
                // What rays are distributed about, and which part of the hemisphere near occluders leave open.
                let n = normalize(textureLoad(normal, pixel, 0).xyz);
                let distance = 1.0 / (params.world_from_clip[2].w * d);
                facing = vec4f(n, near_field_at(vec2f(pixel) + 0.5, distance).open);
                plane = vec4f(flat_normal(vec2i(pixel), p, n), 0.0);
            }
        }
        k++;
        if (k >= count || place.w > 0.0) { break; }
    }
    textureStore(places, id.xy, place);
    textureStore(normals, id.xy, facing);
    textureStore(planes, id.xy, plane);
}
