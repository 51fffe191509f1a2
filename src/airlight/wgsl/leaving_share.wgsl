// The share of reflected light that does not fall back on the surface that the light comes from: all
// but the view factor of a disk of its size, from another one across a gap, or from a point (the
// larger share: close by, points lie between the two, far beside it none does). `body`: m^2, the square
// of the disk's radius, `normal` its own, `away`, m, from it to the point. Twin of maths/area_light.py.
fn leaving_share(away: vec3f, normal: vec3f, body: f32) -> f32 {
    let squared = dot(away, away);
    let height = dot(away, normal);
    let gap = max(height * height, 1e-12) / max(body, 1e-12);
    let across = 0.5 * gap * (sqrt(4.0 / gap + 1.0) - 1.0);
    return max(across, squared / (squared + body));
}
