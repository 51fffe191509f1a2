// The radiance that a cell scatters towards the eye, per unit scattering coefficient. `refined`:
// the furnace corrections of all cells, then the indirect light of surfaces in them.
//! use beam_emission
//! use outgoing_light
//! use sky_gain
//! use store_emission

fn store_mean(cell: vec3u, fluence: vec3f, indirect: vec3f, whole: vec3f) {
    let light = reduced_emission(fluence, indirect, whole, params.g);
    textureStore(mean, cell, vec4f(min(light, vec3f(HALF_MAX)), 1.0));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    let cell = cell_of(id.x);
    // Marching reads no cell out of reach.
    if (reach[id.x] == 0u) {
        store_emission(cell, vec3f(0.0), vec3f(0.0));
        store_mean(cell, vec3f(0.0), vec3f(0.0), vec3f(0.0));
        return;
    }
    // Multiple scattering: forwards only, and diffuse; corrected as in the furnace.
    let point = cell_centre(cell);
    let travel = normalize(view.eye - point + vec3f(1e-12));
    let light = beam_emission(id.x, travel);
    var scattered = light.quasi_forward + diffuse_emission(id.x, travel);
    var fluence = light.quasi_fluence + max(diffuse[id.x].xyz, vec3f(0.0));
    if (view.correction > 0.0) {
        let corrected = pow(refined[id.x].rgb, vec3f(view.correction));
        scattered *= corrected;
        fluence *= corrected;
    }
    // Single scattering of directional lights and the sky, and the indirect light of surfaces.
    let once = light.beams + light.sky * sky_correction_towards(travel);
    let indirect = refined[arrayLength(&refined) / 2u + id.x].rgb;
    let all = once + scattered + indirect;
    store_emission(cell, all, light.local);
    store_mean(cell, light.fluence + fluence, indirect, all + light.local);
}
