// The gather point that a pixel makes. The including pass binds `params` (PointParams), `depth`, `normal` and the near
// field.
//! use pixel_point
//! use flat_normal
//! use ray_start
//! use near_field_lookup

struct GatherPoint {
    place: vec4f,           // m; w: from the eye
    start: vec4f,           // of rays, m; w as of the place
    facing: vec4f,          // what rays are distributed about; w: the part of the hemisphere that near occluders leave
    plane: vec4f,           // normal without relief
}

// `d`: the pixel's depth, over 0.
fn gather_point(pixel: vec2u, d: f32) -> GatherPoint {
    let p = pixel_point(vec2f(pixel) + 0.5, d);
    let n = normalize(textureLoad(normal, pixel, 0).xyz);
    let distance = 1.0 / (params.world_from_clip[2].w * d);
    let open = near_field_at(vec2f(pixel) + 0.5, distance).open;
    let start = ray_start(p, n, params.eye, pixel_width(params.world_from_clip, params.size.y));
    let away = length(p - params.eye);
    return GatherPoint(vec4f(p, away), vec4f(start, away), vec4f(n, open), vec4f(flat_normal(vec2i(pixel), p, n), 0.0));
}
