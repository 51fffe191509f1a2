//! use medium_grid
//! use delta_beam
//! use phase
//! use lattice

// How much of an even light of radiance 1 there is in a cell; see maths/delta_beam.py, fluence.
fn even_radiance(cell: u32) -> vec3f {
    if (bounce.is_whole != 0u) {
        return vec3f(1.0);
    }
    let loss = params.sigma_t * beam_loss(params.g, params.albedo);
    var fluence = diffuse[cell].xyz;
    for (var n = 0u; n < params.ordinate_count; n++) {
        fluence += ordinates[n].irradiance.rgb * exp(-loss * passed[n * params.cells + cell]);
    }
    return clamp(fluence * PHASE_ISOTROPIC, vec3f(0.0), vec3f(1.0));
}

fn radiance(state: vec4f, travel: vec3f, g: f32) -> f32 {
    return max(0.0, state.x + bounce.direct * g * dot(state.yzw, travel));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || reach[id.x] == 0u) {
        return;
    }
    let centre = cell_centre(cell_of(id.x));
    let p = (bounce.world_from_medium * vec4f(centre, 1.0)).xyz;
    let to_eye = normalize(bounce.eye - centre + vec3f(1e-12));
    let travel = (bounce.world_from_medium * vec4f(to_eye, 0.0)).xyz;
    let weight = bounce.scale * lattice_weight(lattice, p);
    var light = vec3f(0.0);
    if (weight > 0.0) {
        let uvw = lattice_coordinates(lattice, p, vec3f(0.0));
        light = weight * even_radiance(id.x) * vec3f(
            radiance(textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0), travel, params.g.r),
            radiance(textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0), travel, params.g.g),
            radiance(textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0), travel, params.g.b));
    }
    bounced[id.x] = vec4f(light, 0.0);
}
