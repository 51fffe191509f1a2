// Adds what the first segments of a batch of paths found to their points' sums, and takes it from the paths.
//! use gather
//! use octahedron
//! use tone

// A path's first segment: its light, at the inverse length `inverse_m`; far where far surfaces begin.
fn with_light(sums: PointSums, radiance: vec3f, inverse_m: f32, along: vec3f) -> PointSums {
    var out = sums;
    // What comes from afar is shared with other neighbours than what comes from near by.
    let is_far = inverse_m > 0.0 && inverse_m * far[0] < 1.0;
    let near = select(radiance, vec3f(0.0), is_far);
    let from_afar = radiance - near;
    out.near += near;
    out.brightest = max(out.brightest, luminance(radiance));
    out.near_flux += luminance(near) * along;
    out.far_share += f32(is_far);
    out.far += from_afar;
    out.far_flux += luminance(from_afar) * along;
    out.far_rays += f32(is_far);
    out.far_inverse_m += select(0.0, inverse_m, is_far);
    // What later segments bring there is added by them.
    out.later_rays += f32(inverse_m > 0.0 && !is_far);
    return out;
}

fn with_sky(sums: PointSums, radiance: vec3f, along: vec3f) -> PointSums {
    var out = sums;
    let light = luminance(radiance);
    out.sky += radiance;
    out.sky_variance += light * light;
    out.sky_flux += light * along;
    return out;
}

// How near what a ray met is: `side`, as paths keep it.
fn with_nearness(sums: PointSums, side: vec4f, inverse_m: f32, most_m: f32) -> PointSums {
    var out = sums;
    let met_normal = octahedron_decode(side.xy);
    // Shorter rays than points are apart would let points share nothing.
    let near = nearness(met_normal, min(max(inverse_m, 0.0), most_m), side.z);
    out.squares += near[0];
    out.products += near[1];
    out.met_rays += select(0.0, 1.0, inverse_m > 0.0);
    out.sides += min(max(inverse_m, 0.0), most_m * LEAST_RAY / LEAST_SIDE) * met_normal;
    return out;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let count = params.reduced.x * params.reduced.y;
    let point = id.y * params.reduced.x + id.x;
    let facing = textureLoad(normals, id.xy, 0);
    let point_m = params.texel * textureLoad(places, id.xy, 0).w;
    let most_m = 1.0 / max(LEAST_RAY * point_m, 1e-9);
    // The sum goes on from the rays before, unless these are the first.
    var sum: PointSums;
    if (params.first_ray > params.begun) {
        sum = sums[point];
    }
    var k = 0u;
    loop {
        if (k >= params.rays) { break; }
        let row = 2u * (point + k * count);
        let path = paths[row];
        let sky = select(vec3f(0.0), paths[row + 1u].rgb, path.w < 0.0);
        let direction = cosine_direction(facing.xyz, ray_numbers(id.x, id.y, params.first_ray + k));
        let along = flux_along(facing.xyz, direction);
        sum = with_light(sum, path.rgb, path.w, along);
        sum = with_sky(sum, sky, along);
        sum = with_nearness(sum, unpack4x8snorm(met[point + k * count]), path.w, most_m);
        // The path goes on without what is added here.
        paths[row] = vec4f(vec3f(0.0), path.w);
        passed[point + k * count] = paths[row + 1u];
        k++;
    }
    sum.open = facing.w;
    sum.far_begins = 1.0 / max(far[0], 1e-9);
    sums[point] = sum;
}
