// Forward light of directional lights in a half space: light that the reduced medium transmits,
// with the fused phase function of its scattering depth; see scatter/forward.wgsl. The including
// pass binds what forward_light.wgsl and half_space.wgsl do.
//! use light_kinds
//! use fused_phase

fn half_space_forward(p: vec3f, travel: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < own.forward_count; i++) {
        let light = row_of_forward_table(i);
        if (light.kind != LIGHT_DIRECTIONAL || light.direction.y > -1e-3) { continue; }
        let path = max(own.half_space_top - p.y, 0.0) / -light.direction.y;
        let depth = dot(media_lit_scattering[0], vec3f(1.0 / 3.0)) * path;
        sum += light.color * exp(-media_reduced_sigma_t[0] * path)
            * fused_phase(0u, dot(light.direction, travel), depth + eye_depth);
    }
    return media_lit_scattering[0] * sum;
}
