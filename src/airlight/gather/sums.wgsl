// Adds the radiance along a batch of paths to their points' sums.
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
    let point_m = params.texel * textureLoad(places, id.xy, 0).w;
    let most_m = 1.0 / max(LEAST_RAY * point_m, 1e-9);
    if (params.first_ray > params.begun) {
        surfaces = sums[at];
        outside = sums[at + 1u];
        flux = sums[at + 2u];
        flux_outside = sums[at + 3u];
        squares = sums[at + 4u];
        products = sums[at + 5u].xyz;
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
        surfaces += vec4f(path.rgb, 0.0);
        outside += vec4f(sky, light * light);
        flux += luminance(path.rgb) * along;
        flux_outside += light * along;
        // Shorter rays than points are apart would let points share nothing.
        let inverse_m = min(max(path.w, 0.0), most_m);
        let side = unpack4x8snorm(met[point + k * count]);
        let near = nearness(octahedron_decode(side.xy), inverse_m, side.z);
        squares += vec4f(near[0], select(0.0, 1.0, path.w > 0.0));
        products += near[1];
        k++;
    }
    flux.w = facing.w;
    sums[at] = surfaces;
    sums[at + 1u] = outside;
    sums[at + 2u] = flux;
    sums[at + 3u] = flux_outside;
    sums[at + 4u] = squares;
    sums[at + 5u] = vec4f(products, 0.0);
}
