// Redraws the listed pixels. Their order differs from run to run, their values do not.
//! use shaft_rays
//! use eye_ray
//! use packed_pixel

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u,
) {
    // There may be more listed pixels than invocations: each redraws several.
    let count = found[0];
    var i = id.x;
    if (i >= count) {
        return;
    }
    loop {
        let entry = chosen[i];
        let pixel = unpacked_pixel(entry.w);
        let direction = pixel_direction(rays.world_from_clip, vec2f(pixel) + 0.5, vec2f(rays.size));
        let reach = pixel_distance(
            rays.world_from_clip, direction, textureLoad(depth, vec2i(pixel), 0));
        let drawn = single_scattered(normalize(direction), reach) + bitcast<vec3f>(entry.xyz);
        textureStore(scattered, pixel, vec4f(drawn, 1.0));
        i += groups.x * WX;
        if (i >= count) { break; }
    }
}
