// What a surface sends back of a light, per texel of its view. Who uses it binds `params` with the light,
// and stores half floats.
//! use half_range
//! use leaving_share

// `albedo` is bihemispherical: a two-band lattice cannot tell gloss from matt.
fn reflected_power(albedo: vec3f, world: vec3f) -> vec3f {
    let power = params.color * albedo;
    if (params.kind < 2u) {
        return in_half_range(power);
    }
    let c = dot(normalize(world - params.position), params.direction);
    if (params.kind == 3u) {    // a sample of a surface
        return in_half_range(power * leaving_share(world - params.position, params.direction, params.body, params.gap)
            * (params.cos_inner * max(c, 0.0) + params.cos_outer));
    }
    return in_half_range(
        power * smoothstep(params.cos_outer, max(params.cos_inner, params.cos_outer + 1e-4), c));
}
