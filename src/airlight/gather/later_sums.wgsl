// Adds what the later segments of a batch of paths found to their points' sums: with the far surfaces' light where the
// first segment met one, and else apart.
//! use gather
//! use tone

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let count = params.reduced.x * params.reduced.y;
    let point = id.y * params.reduced.x + id.x;
    let n = textureLoad(normals, id.xy, 0).xyz;
    var sum = sums[point];
    for (var k = 0u; k < params.rays; k++) {
        // The first segment says where the light comes from, and whether that is far.
        let path = paths[2u * (point + k * count)];
        let direction = cosine_direction(n, ray_numbers(id.x, id.y, params.first_ray + k));
        let along = luminance(path.rgb) * flux_along(n, direction);
        sum.brightest = max(sum.brightest, luminance(path.rgb));
        let is_far = path.w > 0.0 && path.w * far[0] < 1.0;
        sum.far += select(vec3f(0.0), path.rgb, is_far);
        sum.far_flux += select(vec3f(0.0), along, is_far);
        sum.later += select(path.rgb, vec3f(0.0), is_far);
        sum.later_flux += select(along, vec3f(0.0), is_far);
    }
    sums[point].far = sum.far;
    sums[point].far_flux = sum.far_flux;
    sums[point].later = sum.later;
    sums[point].later_flux = sum.later_flux;
    sums[point].brightest = sum.brightest;
}
