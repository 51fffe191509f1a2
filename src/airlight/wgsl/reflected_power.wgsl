// What a surface sends back of a light, per texel of its view. Who uses it binds `params` with the light,
// and stores half floats.
//! use half_range
//! use leaving_share
//! use light_kinds

// `albedo` is bihemispherical: a two-band lattice cannot tell gloss from matt.
fn reflected_power(albedo: vec3f, world: vec3f) -> vec3f {
    var power = params.color * albedo;
    if (sends_by_direction(params.kind)) {
        let away = world - params.position;
        if (params.body > 0.0) {    // a sample of a surface, on which some of the light falls back
            power *= leaving_share(away, params.direction, params.body, params.gap);
        }
        power *= share_at(params.kind, dot(normalize(away), params.direction), vec2f(params.shape_x, params.shape_y));
    }
    return in_half_range(power);
}
