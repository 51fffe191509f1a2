// Adds what the first segments of a batch of paths found to their points' sums, and takes it from the paths.
//! use gather
//! use octahedron

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
    var squares = vec4f(0.0);
    var products = vec3f(0.0);
    var from_afar = vec4f(0.0);
    var flux_from_afar = vec4f(0.0);
    var sides = vec3f(0.0);
    var later = vec4f(0.0);
    var later_flux = vec4f(0.0);
    let point_m = params.texel * textureLoad(places, id.xy, 0).w;
    let most_m = 1.0 / max(LEAST_RAY * point_m, 1e-9);
    if (params.first_ray > params.begun) {
        surfaces = sums[at];
        outside = sums[at + 1u];
        flux = sums[at + 2u];
        flux_outside = sums[at + 3u];
        squares = sums[at + 4u];
        products = sums[at + 5u].xyz;
        from_afar = sums[at + 6u];
        flux_from_afar = sums[at + 7u];
        sides = sums[at + 8u].xyz;
        later = sums[at + 9u];
        later_flux = sums[at + 10u];
    }
    var k = 0u;
    loop {
        if (k >= params.rays) { break; }
        let row = 2u * (point + k * count);
        let path = paths[row];
        let is_outside = path.w < 0.0;
        let sky = select(vec3f(0.0), paths[row + 1u].rgb, is_outside);
        let direction = cosine_direction(facing.xyz, ray_numbers(id.x, id.y, params.first_ray + k));
        let along = vec4f(flux_along(facing.xyz, direction), 0.0);
        let light = luminance(sky);
        // What comes from afar is shared with other neighbours than what comes from near by.
        let is_far = path.w > 0.0 && path.w * far[0] < 1.0;
        let near_light = select(path.rgb, vec3f(0.0), is_far);
        let far_light = path.rgb - near_light;
        surfaces += vec4f(near_light, f32(is_far));
        flux += luminance(near_light) * along;
        from_afar += vec4f(far_light, f32(is_far));
        flux_from_afar += luminance(far_light) * along + vec4f(vec3f(0.0), select(0.0, path.w, is_far));
        outside += vec4f(sky, light * light);
        flux_outside += light * along;
        // The path goes on without what is added here.
        later.w += f32(path.w > 0.0 && !is_far);
        paths[row] = vec4f(vec3f(0.0), path.w);
        // Shorter rays than points are apart would let points share nothing.
        let inverse_m = min(max(path.w, 0.0), most_m);
        let side = unpack4x8snorm(met[point + k * count]);
        let met_normal = octahedron_decode(side.xy);
        let near = nearness(met_normal, inverse_m, side.z);
        squares += vec4f(near[0], select(0.0, 1.0, path.w > 0.0));
        products += near[1];
        sides += min(max(path.w, 0.0), most_m * LEAST_RAY / LEAST_SIDE) * met_normal;
        k++;
    }
    flux.w = facing.w;
    sums[at] = surfaces;
    sums[at + 1u] = outside;
    sums[at + 2u] = flux;
    sums[at + 3u] = flux_outside;
    sums[at + 4u] = squares;
    sums[at + 5u] = vec4f(products, 0.0);
    sums[at + 6u] = from_afar;
    sums[at + 7u] = flux_from_afar;
    sums[at + 8u] = vec4f(sides, 1.0 / max(far[0], 1e-9));
    sums[at + 9u] = later;
    sums[at + 10u] = later_flux;
}
