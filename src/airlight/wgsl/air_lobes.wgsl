// Light in the air that goes about one way, as media scatter it; see maths/air_lobes.py.
//! use phase
//! use tone

struct AirLobe {
    mean: vec3f,        // radiance over all directions
    sharpness: f32,     // mean cosine to the way that it goes
    cosine: f32,        // of that way to a ray's direction of travel
}

// `mean`: radiance; `along`: of its luminance, times the mean direction.
fn air_lobe(mean: vec3f, along: vec3f, travel: vec3f) -> AirLobe {
    let light = max(mean, vec3f(0.0));
    let flux = length(along);
    let sharpness = min(flux / max(luminance(light), 1e-20), 1.0);
    return AirLobe(light, sharpness, dot(along, travel) / max(flux, 1e-20));
}

// What a medium of mean cosine g scatters of it into the ray, per scattering coefficient.
fn scattered_lobe(lobe: AirLobe, g: vec3f) -> vec3f {
    return lobe.mean * scattering_phase(lobe.cosine, lobe.sharpness * g) / PHASE_ISOTROPIC;
}

// What it scatters along one way over what it scatters along another.
fn turned_lobe(wanted: AirLobe, given: AirLobe, g: vec3f) -> vec3f {
    return scattering_phase(wanted.cosine, wanted.sharpness * g) / scattering_phase(given.cosine, given.sharpness * g);
}
