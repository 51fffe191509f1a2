// Adds the radiance along a batch of paths to their points' sums.
//! use gather

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let count = params.reduced.x * params.reduced.y;
    let point = id.y * params.reduced.x + id.x;
    let at = SUMS * point;
    let facing = textureLoad(normals, id.xy, 0);
    var surfaces = vec4f(0.0);
    var outside = vec4f(0.0);
    var flux = vec4f(0.0);
    var flux_outside = vec4f(0.0);
    if (params.first_ray > params.begun) {
        surfaces = sums[at];
        outside = sums[at + 1u];
        flux = sums[at + 2u];
        flux_outside = sums[at + 3u];
    }
    var k = 0u;
    loop {
        if (k >= params.rays) { break; }
        let path = paths[2u * (point + k * count)];
        let direction = cosine_direction(facing.xyz, ray_numbers(id.x, id.y, params.first_ray + k));
        let light = luminance(path.rgb);
        let its_flux = vec4f(light * flux_along(facing.xyz, direction), 0.0);
        let is_outside = path.w < 0.0;
        surfaces += select(path, vec4f(0.0), is_outside);
        outside += select(vec4f(0.0), vec4f(path.rgb, light * light), is_outside);
        flux += select(its_flux, vec4f(0.0), is_outside);
        flux_outside += select(vec4f(0.0), its_flux, is_outside);
        k++;
    }
    flux.w = facing.w;
    sums[at] = surfaces;
    sums[at + 1u] = outside;
    sums[at + 2u] = flux;
    sums[at + 3u] = flux_outside;
}
