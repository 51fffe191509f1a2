// Emission of light that the reduced medium transmits, light by light; see
// media/march/forward_source.py. The including pass binds forward_slots and what march.wgsl does.
//! use light_kinds
//! use fused_phase
//! use march_lattice
//! use media_here
//! needs fn inside_lattices() -> f32

// A light in the cells around a point, at texture coordinates that are one light's; of nested lattices
// the mean, by the share of each.
fn forward_at(lights: texture_3d<f32>, uvw: vec3f, i: u32) -> vec4f {
    let at = vec3f(uvw.xy, (uvw.z + f32(i)) / own.forward_slabs);
    return textureSampleLevel(lights, linear_clamp, at, 0.0);
}

fn forward_here(lights: texture_3d<f32>, i: u32) -> vec4f {
    if (LATTICES_AT_ONCE == 1u) {
        return forward_at(lights, lattice_at[0].xyz, i);
    }
    var sum = vec4f(0.0);
    var weight = 0.0;
    var k = 0u;
    loop {
        sum += lattice_at[k].w * forward_at(lights, lattice_at[k].xyz, i);
        weight += lattice_at[k].w;
        k++;
        if (k >= LATTICES_AT_ONCE || lattice_at[min(k, LATTICES_AT_ONCE - 1u)].w <= 0.0) {
            break;
        }
    }
    return sum / weight;
}

// How fast beams spread, m^-2: over cells of the finest lattice here.
fn forward_spread_here() -> f32 {
    return own.forward_spread * lattice_gain[0];
}

// The light that a step scatters to the eye. `reached`: metres of the step, times the transmittance
// of the media; `reduced_reached`: times that of the reduced media. Light that is scattered again
// on its path to the eye is blurred, by .29 sqrt(2 (1 - g)) of the path.
fn forward_light(
    p: vec3f, travel: vec3f, reached: vec3f, reduced_reached: vec3f,
) -> vec3f {
    var sum = vec3f(0.0);
    if (lattice_at[0].w <= 0.0) { return sum; }
    let spread = forward_spread_here() * eye_path * eye_path;
    for (var i = 0u; i < own.forward_count; i++) {
        // What arrives of a light, in the cell and around it.
        let light = forward_here(forward_lights, i);
        let wide = forward_here(forward_blurred, i).rgb;
        if (all(light.rgb + wide <= vec3f(0.0))) { continue; }
        var direction = row_of_forward_table(i).direction;
        if (row_of_forward_table(i).kind != LIGHT_DIRECTIONAL) {
            direction = normalize(p - row_of_forward_table(i).position);
        }
        // What each medium scatters of it.
        let mu = dot(direction, travel);
        for (var j = 0u; j < media_here(); j++) {
            let k = medium_here(j);
            let m = ray_medium(k);
            let before = fused_phase(m, mu, light.a) * reached;
            let all = fused_phase(m, mu, light.a + eye_depth) * reduced_reached;
            let far = saturate(spread * (1.0 - row_of_media(m).g.g));
            let scattering = media_density_here[k] * lit_scattering_of(m);
            sum += scattering
                * (light.rgb * before + mix(light.rgb, wide, far) * max(all - before, vec3f(0.0)));
        }
    }
    return own.forward_scale * inside_lattices() * sum;
}
