// Rays against a box, 0..1 on each axis of its own space, that is wider by `half` on all sides.

// From `o` along `d`, at most `reach` of its lengths.
fn meets_wider_box(o: vec3f, d: vec3f, reach: f32, half: vec3f) -> bool {
    let inverse = 1.0 / select(d, vec3f(1e-30), abs(d) < vec3f(1e-30));
    let a = (-half - o) * inverse;
    let b = (1.0 + half - o) * inverse;
    let near = min(a, b);
    let far = max(a, b);
    return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, reach));
}
