//! use eye_ray

// Weights of joint bilateral upsampling by depth (Kopf2007). The including pass binds rays
// (RayParams) and depth.

// Texels farther off than this share of the depth lose their weight.
const DEPTH_TOLERANCE = 0.05;
// A texel of the right depth wins even where bilinear interpolation hardly counts it.
const LEAST_SHARE = 0.02;

fn depth_weight(a: f32, b: f32) -> f32 {
    let off = abs(a - b) / (DEPTH_TOLERANCE * min(a, b));
    return 1.0 / (1.0 + off * off * off * off);
}

// The path to the surface that a pixel shows, m.
fn own_distance(position: vec2f) -> f32 {
    let direction = pixel_direction(rays.world_from_clip, position, vec2f(rays.size));
    return pixel_distance(rays.world_from_clip, direction,
        textureLoad(depth, vec2i(position), 0));
}

struct Corner {
    texel: vec2i,
    share: f32,     // bilinear
}

// The k-th of four texels around a pixel. A texel's ray is that of the middle pixel of its block (media/rays.wgsl).
fn corner_of(position: vec2f, k: u32) -> Corner {
    let at = (position - 0.5 - f32(rays.scale / 2u)) / f32(rays.scale);
    let last = vec2i(rays.reduced) - 1;
    // Four different texels even at the image's edge, so that both of a block's sides are there.
    let base = clamp(floor(at), vec2f(0.0), vec2f(max(last - 1, vec2i(0))));
    let t = saturate(at - base);
    let corner = vec2u(k & 1u, k >> 1u);
    let texel = min(vec2i(base) + vec2i(corner), last);
    let share = select(1.0 - t, t, corner == vec2u(1u));
    return Corner(texel, share.x * share.y);
}

// Of a corner of bilinear `share` whose depth counts by `likeness` (depth_weight).
fn corner_weight(share: f32, likeness: f32) -> f32 {
    return (share + LEAST_SHARE) * likeness + 1e-9;
}
