// Paths through other media. The including pass binds `params` (MediumParams), `media` (MixedData),
// `linear_clamp` and the textures of fine_of (pop/medium/mixture.py).
//! use medium
//! needs fn fine_of(m: u32, uvw: vec3f) -> f32

// Density of medium m on a ray from `begin` to `end`, m of density 1, in the own medium's frame.
fn density_between(m: u32, origin: vec3f, direction: vec3f, begin: f32, end: f32) -> f32 {
    let to = row_of_media(m).uvw_from_medium;
    let o = (to * vec4f(origin, 1.0)).xyz;
    let d = (to * vec4f(direction, 0.0)).xyz;
    let span = ray_box_interval(o, d, vec3f(0.0), vec3f(1.0));
    let a = max(span.x, begin);
    let b = min(span.y, end);
    if (a >= b) {
        return 0.0;
    }
    let steps = max(1.0, ceil((b - a) / row_of_media(m).cell));
    let dt = (b - a) / steps;
    var sum = 0.0;
    for (var k = 0.5; k < steps; k += 1.0) {
        sum += fine_of(m, o + (a + k * dt) * d);
    }
    return sum * dt;
}
