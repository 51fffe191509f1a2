//! use eye_ray

// Weights of joint bilateral upsampling by depth (Kopf et al. 2007). The including pass binds rays
// (RayParams), depth and picked.

// Texels farther off than this share of the depth lose their weight.
const DEPTH_TOLERANCE = 0.05;
// A texel of the right depth wins even where bilinear interpolation hardly counts it.
const LEAST_SHARE = 0.02;

fn depth_weight(a: f32, b: f32) -> f32 {
    let off = abs(a - b) / (DEPTH_TOLERANCE * min(a, b));
    return 1.0 / (1.0 + off * off * off * off);
}

// The way to what a pixel shows, m.
fn own_distance(position: vec2f) -> f32 {
    let direction = pixel_direction(rays.world_from_clip, position, vec2f(rays.size));
    return pixel_distance(rays.world_from_clip, direction,
        textureLoad(depth, vec2i(position), 0));
}

struct Upsampled {
    texel: vec2i,
    weight: f32,
}

// The k-th of four texels around a pixel that sees `own` metres far.
fn upsampled(position: vec2f, own: f32, k: u32) -> Upsampled {
    let place = position / f32(rays.scale) - 0.5;
    let last = vec2i(rays.reduced) - 1;
    // Four different texels even at the picture's edge, so that both of a block's sides are there.
    let base = clamp(floor(place), vec2f(0.0), vec2f(max(last - 1, vec2i(0))));
    let t = saturate(place - base);
    let corner = vec2u(k & 1u, k >> 1u);
    let texel = min(vec2i(base) + vec2i(corner), last);
    let share = select(1.0 - t, t, corner == vec2u(1u));
    let distance = textureLoad(picked, texel, 0).x;
    return Upsampled(texel,
        (share.x * share.y + LEAST_SHARE) * depth_weight(distance, own) + 1e-9);
}
