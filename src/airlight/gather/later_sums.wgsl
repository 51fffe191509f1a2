// Adds what the later segments of a batch of paths found to their points' sums: with the far surfaces' light where the
// first segment met one, and else apart.
//! use gather

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let count = params.reduced.x * params.reduced.y;
    let point = id.y * params.reduced.x + id.x;
    let at = SUMS * point;
    let n = textureLoad(normals, id.xy, 0).xyz;
    var from_afar = sums[at + 6u];
    var flux_from_afar = sums[at + 7u];
    var later = sums[at + 9u];
    var later_flux = sums[at + 10u];
    for (var k = 0u; k < params.rays; k++) {
        let path = paths[2u * (point + k * count)];
        let direction = cosine_direction(n, ray_numbers(id.x, id.y, params.first_ray + k));
        let along = luminance(path.rgb) * vec4f(flux_along(n, direction), 0.0);
        let is_far = path.w > 0.0 && path.w * far[0] < 1.0;
        from_afar += select(vec4f(0.0), vec4f(path.rgb, 0.0), is_far);
        flux_from_afar += select(vec4f(0.0), along, is_far);
        later += select(vec4f(path.rgb, 0.0), vec4f(0.0), is_far);
        later_flux += select(along, vec4f(0.0), is_far);
    }
    sums[at + 6u] = from_afar;
    sums[at + 7u] = flux_from_afar;
    sums[at + 9u] = later;
    sums[at + 10u] = later_flux;
}
