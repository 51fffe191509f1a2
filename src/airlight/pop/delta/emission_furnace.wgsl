// White furnace: under a uniform sky of radiance 1 a medium without absorption scatters exactly 1
// everywhere. The correction is the factor of multiple scattering for which that holds.
//! use beam_emission
//! use sky_gain

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || reach[id.x] == 0u) {
        return;
    }
    // What is scattered towards the eye: once, and more often.
    let point = cell_centre(cell_of(id.x));
    let travel = normalize(view.eye - point + vec3f(1e-12));
    let light = beam_emission(id.x, travel);
    let multiple = light.quasi_forward + diffuse_emission(id.x, travel);
    let once = light.sky * sky_correction_towards(travel);
    let c = (1.0 - once) / max(multiple, vec3f(1e-6));
    corrections[id.x] = vec4f(clamp(c, vec3f(0.5), vec3f(2.0)), 0.0);
}
