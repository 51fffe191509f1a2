// Highlights of lights with extent, by samples.
//! use area_shadow
//! use surface_reflection

// GGX towards what looks as wide as `wide`: half vectors turn by half as much, and by more across the plane of view.
fn widened_lobe(at: Viewed, l: vec3f, alpha: f32, wide: f32) -> f32 {
    let n_v = max(dot(at.n, at.v), 1e-4);
    let both = at.v + l;
    let squared = max(dot(both, both), 1e-8);
    let n_h = dot(at.n, both);
    let side = dot(l, cross(at.n, at.v));
    let h = vec2f(n_h * n_h, side * side / max(1.0 - n_v * n_v, 1e-6)) / squared;
    let along = min(alpha + 0.5 * wide, 1.0);
    let across = min(alpha + wide * inverseSqrt(squared), 1.0);
    let d = h.x + h.y / (across * across) + max(1.0 - h.x - h.y, 0.0) / (along * along);
    return smith_visibility(max(dot(at.n, l), 0.0), n_v, along) / (along * across * d * d);
}
