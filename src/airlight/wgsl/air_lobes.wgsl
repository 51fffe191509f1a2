// Light in the air that goes about one way, as media scatter it; see maths/air_lobes.py.
//! use phase
//! use tone

// The phase function, over isotropic scattering, of light of a luminance and `along`, that times the mean direction, into
// rays that travel some way in a medium of mean cosine g.
fn lobe_phase(light: f32, along: vec3f, travel: vec3f, g: vec3f) -> vec3f {
    let flux = length(along);
    let sharpness = min(flux / max(light, 1e-20), 1.0);
    return scattering_phase(dot(along, travel) / max(flux, 1e-20), sharpness * g) / PHASE_ISOTROPIC;
}

// What a medium scatters of light of a `mean` radiance into such rays, per scattering coefficient.
fn scattered_lobe(mean: vec3f, along: vec3f, travel: vec3f, g: vec3f) -> vec3f {
    let light = max(mean, vec3f(0.0));
    return light * lobe_phase(luminance(light), along, travel, g);
}

// The same into rays that travel one way over that into those that travel another.
fn turned_lobe(flow: vec4f, travel: vec3f, given: vec3f, g: vec3f) -> vec3f {
    return lobe_phase(flow.w, flow.xyz, travel, g) / lobe_phase(flow.w, flow.xyz, given, g);
}
