// What a surface sends back of a light, per texel of its view. Who uses it binds `params` with the light,
// and stores half floats.
//! use half_range

fn reflected_power(base_color: vec3f, world: vec3f) -> vec3f {
    // Metals count with their whole reflectance: a two-band lattice cannot tell gloss from matt.
    let power = params.color * base_color;
    if (params.kind != 2u) {
        return in_half_range(power);
    }
    let c = dot(normalize(world - params.position), params.direction);
    return in_half_range(
        power * smoothstep(params.cos_outer, max(params.cos_inner, params.cos_outer + 1e-4), c));
}
