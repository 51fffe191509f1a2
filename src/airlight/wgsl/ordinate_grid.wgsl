// Density passed along an ordinate; see maths/ordinate_grid.py. The including pass binds
// `ordinates` (OrdinateData) and `passed` (array<f32>), and `params` (MediumParams).

// A point, m in the medium's box, in cells of ordinate n's grid.
fn ordinate_place(n: u32, point: vec3f) -> vec3f {
    let o = ordinates[n];
    let p = point - 0.5 * params.extent;
    let local = vec3f(dot(o.u.xyz, p), dot(o.v.xyz, p), dot(o.direction.xyz, p));
    return (local - vec3f(o.u.w, o.v.w, o.direction.w)) / o.cell.xyz;
}

fn passed_pair(first: u32, i: vec2u, w: f32) -> f32 {
    return mix(passed[first + i.x], passed[first + i.y], w);
}

// Density passed, m: trilinear between faces along the light and centres across it.
fn passed_at(n: u32, place: vec3f) -> f32 {
    let side = params.side;
    let top = vec3f(f32(side - 1u), f32(side - 1u), f32(side));
    let at = clamp(place - vec3f(0.5, 0.5, 0.0), vec3f(0.0), top);
    let low = min(vec3u(at), vec3u(top) - 1u);
    let w = at - vec3f(low);
    let i = vec2u(low.x, low.x + 1u);
    let row = ((n * (side + 1u) + low.z) * side + low.y) * side;
    let layer = side * side;
    let near = mix(passed_pair(row, i, w.x), passed_pair(row + side, i, w.x), w.y);
    let far = mix(passed_pair(row + layer, i, w.x), passed_pair(row + layer + side, i, w.x), w.y);
    return mix(near, far, w.z);
}
