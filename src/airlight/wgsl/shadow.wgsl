// Percentage-closer filtering of an array of depth maps. The including pass declares LightViewData.

// Bilinear comparisons on the corners of two turned squares: a soft edge of about three texels.
const SHADOW_OUTER = vec2f(-0.35, -1.05);
const SHADOW_INNER = vec2f(-0.95, -0.55) * 0.45;

override SHADOW_REACH: f32 = 1.0;       // times as far

fn lit_corners(
    maps: texture_depth_2d_array, compare: sampler_comparison, uv: vec2f, corner: vec2f, layer: u32,
    depth: f32,
) -> f32 {
    let beside = vec2f(-corner.y, corner.x);
    return 0.25 * (textureSampleCompareLevel(maps, compare, uv + corner, layer, depth)
        + textureSampleCompareLevel(maps, compare, uv + beside, layer, depth)
        + textureSampleCompareLevel(maps, compare, uv - corner, layer, depth)
        + textureSampleCompareLevel(maps, compare, uv - beside, layer, depth));
}

// A surface point before a light's view.
struct ShadowPoint {
    uv: vec2f,
    depth: f32,
    distance: f32,      // along the view's axis, m; 1 where it is parallel
    is_inside: bool,    // else the view says nothing of it
}

// The point is moved along its normal by about two texels, so that a texel that straddles a slope does
// not shadow itself.
fn shadow_point(
    view: LightViewData, position: vec3f, normal: vec3f, to_light: vec3f, distance_m: f32,
) -> ShadowPoint {
    let scale = select(1.0, distance_m, view.is_perspective != 0u);
    let texel_m = max(view.texel.x, view.texel.y) * scale;
    let slope = sqrt(max(0.0, 1.0 - pow(dot(normal, to_light), 2.0)));
    let moved = position + normal * texel_m * (0.5 + 2.0 * slope) + to_light * texel_m * 0.5;
    let clip = view.clip_from_world * vec4f(moved, 1.0);
    let ndc = clip.xyz / max(clip.w, 1e-30);
    let coordinates = ndc.xy * vec2f(0.5, -0.5) + 0.5;
    // A local light's views end where its light does, or at the next one's edge, over which the move may
    // have taken the point: the outermost texels then stand for it.
    let uv = select(coordinates, saturate(coordinates), view.is_perspective != 0u);
    let is_outside = any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) || ndc.z >= 1.0;
    return ShadowPoint(uv, ndc.z, clip.w, clip.w > 0.0 && !is_outside);
}

// The lit share of a surface point.
fn lit_share(
    maps: texture_depth_2d_array, compare: sampler_comparison, view: LightViewData, layer: u32,
    position: vec3f, normal: vec3f, to_light: vec3f, distance_m: f32,
) -> f32 {
    let point = shadow_point(view, position, normal, to_light, distance_m);
    if (!point.is_inside) {
        return 1.0;
    }
    let texel = SHADOW_REACH / f32(textureDimensions(maps).x);
    // No edge comes between corners of the outer square that agree. A loop: drivers that run both
    // sides of a branch end it where none of the pixels at hand is at an edge.
    var sum = 0.0;
    var turns = 0.0;
    var corner = SHADOW_OUTER * texel;
    loop {
        let lit = lit_corners(maps, compare, point.uv, corner, layer, point.depth);
        sum += lit;
        turns += 1.0;
        corner = SHADOW_INNER * texel;
        if (turns > 1.5 || lit <= 0.0 || lit >= 1.0) { break; }
    }
    return sum / turns;
}
