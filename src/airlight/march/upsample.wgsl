//! use eye_ray

// Texels farther off than this share of the depth lose their weight.
const DEPTH_TOLERANCE = 0.05;
// A texel of the right depth wins even where bilinear interpolation hardly counts it.
const LEAST_SHARE = 0.02;

fn depth_weight(a: f32, b: f32) -> f32 {
    let off = abs(a - b) / (DEPTH_TOLERANCE * min(a, b));
    return 1.0 / (1.0 + off * off * off * off);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = pixel_direction(rays.world_from_clip, position.xy, vec2f(rays.size));
    let own = pixel_distance(rays.world_from_clip, direction,
        textureLoad(depth, vec2i(position.xy), 0));
    let place = position.xy / f32(rays.scale) - 0.5;
    let last = vec2i(rays.reduced) - 1;
    // Four different texels even at the picture's edge, so that both of a block's sides are there.
    let base = clamp(floor(place), vec2f(0.0), vec2f(max(last - 1, vec2i(0))));
    let t = saturate(place - base);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let corner = vec2u(k & 1u, k >> 1u);
        let texel = min(vec2i(base) + vec2i(corner), last);
        let share = select(1.0 - t, t, corner == vec2u(1u));
        let distance = textureLoad(picked, texel, 0).x;
        let weight = (share.x * share.y + LEAST_SHARE) * depth_weight(distance, own) + 1e-9;
        sum += weight * textureLoad(reduced, texel, 0);
        total += weight;
    }
    return sum / total + base_at(vec2i(position.xy));
}
