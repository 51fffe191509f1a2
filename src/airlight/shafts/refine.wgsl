// Pixels around which texels of the reduced picture differ are drawn anew.
//! use shaft_rays

fn differs_around(pixel: vec2u) -> bool {
    let centre = vec2i(pixel / rays.scale);
    let last = vec2i(rays.reduced) - 1;
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    for (var k = 0; k < 9; k++) {
        let texel = clamp(centre + vec2i(k % 3, k / 3) - 1, vec2i(0), last);
        let value = textureLoad(reduced, texel, 0).rgb;
        least = min(least, value);
        most = max(most, value);
    }
    return any(most - least > refine.contrast * most);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.size) || !differs_around(id.xy)) {
        return;
    }
    let way = pixel_direction(rays.world_from_clip, vec2f(id.xy) + 0.5, vec2f(rays.size));
    let reach = pixel_distance(rays.world_from_clip, way, textureLoad(depth, vec2i(id.xy), 0));
    textureStore(scattered, id.xy, vec4f(single_scattered(normalize(way), reach), 1.0));
}
