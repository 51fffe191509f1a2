// A ray from each listed pixel, mirrored at a microfacet that the eye sees; writes the surface that it meets.
//! use pixel_point
//! use ray_start
//! use gather
//! use gather_hit
//! use packed_pixel
//! use flat_normal
//! use ggx_sampling
//! use glow_share

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.batch)) {
        return;
    }
    let at = id.y * params.batch.x + id.x;
    let row = params.first + at;
    var hit = no_ray();
    var start = vec4f(0.0);
    if (row < found[0]) {
        next_pixels[at] = listed[row];
        let pixel = unpacked_pixel(listed[row]);
        let p = pixel_point(vec2f(pixel) + 0.5, textureLoad(depth, pixel, 0));
        let facing = textureLoad(normal, pixel, 0);
        let n = normalize(facing.xyz);
        let away = params.eye - p;
        // The direction to the eye, about the normal.
        let frame = orthonormal_frame(n);
        var v = normalize(away) * frame;
        v.z = max(v.z, 1e-4);
        // A microfacet that the eye sees, and the direction that it mirrors.
        let alpha = max(facing.w * facing.w, 0.002);
        let h = visible_normal(v, alpha, ray_numbers(pixel.x, pixel.y, params.sample));
        let mirrored = reflect(-v, h);
        if (mirrored.z > 0.0) {
            // What relief and smooth normals mirror below their surface comes back up.
            var direction = frame * mirrored;
            let flat = flat_normal(vec2i(pixel), p, n);
            direction -= 2.0 * min(dot(direction, flat), 0.0) * flat;
            start = vec4f(ray_start(p, n, params.eye, params.texel), packed_glow_share(medium_glow_share(alpha)));
            hit = gather_hit(start.xyz, direction);
        }
    }
    textureStore(next_starts, id.xy, start);
    store_hit(id.xy, hit);
}
