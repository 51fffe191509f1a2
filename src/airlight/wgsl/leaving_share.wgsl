// The share of reflected light that does not fall back on the surface that the light comes from: all
// but the view factor of a disk of its size, from another one across a gap, or from a point (the
// larger share: close by, points lie between the two, far beside it none does). `body`: m^2, the square
// of the disk's radius, `normal` its own, `away`, m, from it to the point. Beyond about `gap_m`, m, lattices know the light's surface and what it
// takes themselves. Twin of maths/area_light.py.
fn leaving_share(away: vec3f, normal: vec3f, body: f32, gap_m: f32) -> f32 {
    let squared = dot(away, away);
    let height = dot(away, normal);
    let gap = max(height * height, 1e-12) / max(body, 1e-12);
    let across = 0.5 * gap * (sqrt(4.0 / gap + 1.0) - 1.0);
    let share = max(across, squared / (squared + body));
    return mix(share, 1.0, smoothstep(0.5 * gap_m, 1.5 * gap_m + 1e-9, abs(height)));
}
