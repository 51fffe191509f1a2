// Adds the radiance along a batch of paths to their points' sums.
//! use gather

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    var surfaces = vec4f(0.0);
    var outside = vec4f(0.0);
    let count = params.reduced.x * params.reduced.y;
    let point = id.y * params.reduced.x + id.x;
    let at = SUMS * point;
    if (params.first_ray > params.begun) {
        surfaces = sums[at];
        outside = sums[at + 1u];
    }
    var k = 0u;
    loop {
        if (k >= params.rays) { break; }
        let path = paths[2u * (point + k * count)];
        let is_outside = path.w < 0.0;
        surfaces += select(path, vec4f(0.0), is_outside);
        outside += select(vec4f(0.0), vec4f(path.rgb, 0.0), is_outside);
        k++;
    }
    outside.w += f32(params.rays);
    sums[at] = surfaces;
    sums[at + 1u] = outside;
    sums[at + 2u] = textureLoad(normals, id.xy, 0);
}
