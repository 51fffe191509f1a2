// Adds what rays towards lit surfaces found to their points' sums: the light of lights there, as far as rays by the
// cosine leave it to them.
//! use gather
//! use light_guide
//! use tone
//! needs fn passed_by_ray(row: u32) -> vec3f

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let start = textureLoad(starts, id.xy, 0);
    let n = textureLoad(normals, id.xy, 0).xyz;
    let origin = start.xyz;
    var sum = vec3f(0.0);
    var flux = vec3f(0.0);
    // Of each ray's light the share that rays by the cosine leave to it.
    for (var k = 0u; k < params.guided; k++) {
        let texel = vec2u(id.x, id.y + k * params.reduced.y);
        let hit = textureLoad(hit_positions, texel, 0);
        if (start.w > 0.0 && hit.w > 0.0) {
            let direction = normalize(hit.xyz - origin);
            let density = guide_density(origin, n, direction);
            let share = sky_share(dot(direction, n), density, params.rays, params.guided);
            let passed = passed_by_ray(2u * (texel.y * params.reduced.x + texel.x));
            let found = share * passed * textureLoad(direct_light, texel, 0).rgb;
            sum += found;
            flux += luminance(found) * flux_along(n, direction);
        }
    }
    let at = id.y * params.reduced.x + id.x;
    sums[at].near += sum;
    sums[at].near_flux += flux;
}
