// How far a local light at a point of a medium's box, m, counts as one inside, whose light does not enter at the border:
// 1 inside, 0 from a medium's radius beside the box on (twin: maths.point_light_beam.inner_share).
fn inner_share(position: vec3f, extent: vec3f, radius: f32) -> f32 {
    let outside = max(max(-position, position - extent), vec3f(0.0));
    return saturate(1.0 - length(outside) / radius);
}
