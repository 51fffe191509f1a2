// Emission of light that the reduced medium transmits, light by light; see
// media/march/forward_source.py. The including pass binds forward_slots and what march.wgsl does.
//! use lights
//! use fused_phase
//! use march_lattice
//! needs fn inside_lattices() -> f32

// The light that a step scatters to the eye. `reached`: metres of the step, times the transmittance
// of the media; `reduced_reached`: times that of the reduced media. Light that is scattered again
// on its path to the eye is blurred, by .29 sqrt(2 (1 - g)) of the path.
fn forward_light(
    p: vec3f, travel: vec3f, reached: vec3f, reduced_reached: vec3f,
) -> ForwardLight {
    var sum = ForwardLight(vec3f(0.0), vec3f(0.0));
    if (lattice_at[0].w <= 0.0) { return sum; }
    for (var i = 0u; i < own.forward_count; i++) {
        // What arrives of a light, in the cell and around it.
        let uvw = vec3f(lattice_at[0].xy, (lattice_at[0].z + f32(i)) / own.forward_slabs);
        let light = textureSampleLevel(forward_lights, linear_clamp, uvw, 0.0);
        let wide = textureSampleLevel(forward_blurred, linear_clamp, uvw, 0.0).rgb;
        if (all(light.rgb + wide <= vec3f(0.0))) { continue; }
        var direction = forward_table[i].direction;
        if (forward_table[i].kind != LIGHT_DIRECTIONAL) {
            direction = normalize(p - forward_table[i].position);
        }
        // What each medium scatters of it: at last towards the eye, and on towards it.
        let mu = dot(direction, travel);
        for (var m = 0u; m < MEDIA_COUNT; m++) {
            let before = fused_phase(m, mu, light.a) * reached;
            let all = fused_phase(m, mu, light.a + eye_depth) * reduced_reached;
            let far = saturate(own.forward_spread * (1.0 - media[m].g.g) * eye_path * eye_path);
            let scattering = media_density_here[m] * media_lit_scattering[m];
            sum.last += scattering * light.rgb * last_phase(m, mu, light.a) * reached;
            sum.on += scattering
                * (light.rgb * before + mix(light.rgb, wide, far) * max(all - before, vec3f(0.0)));
        }
    }
    let scale = own.forward_scale * inside_lattices();
    return ForwardLight(scale * sum.last, scale * sum.on);
}
