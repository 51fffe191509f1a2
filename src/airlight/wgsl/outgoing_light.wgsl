//! use phase
//! use delta_beam

// Diffuse light that goes towards an eye; see maths/outgoing_light.py. One value per channel.

fn phase_rgb(mu: vec3f, g: vec3f) -> vec3f {
    return vec3f(henyey_greenstein(mu.r, g.r), henyey_greenstein(mu.g, g.g), henyey_greenstein(mu.b, g.b));
}

// Directions of light that leaves beams of a mean cosine.
fn leaving_lobe(mu: vec3f, g: vec3f, sharpness: vec3f, unturned: vec3f) -> vec3f {
    let f = forward_share(g);
    let peak = f * phase_rgb(mu, (1.0 + 2.0 * g) / 3.0 * sharpness);
    let rest = max(phase_rgb(mu, g * sharpness) - peak, vec3f(0.0)) / (1.0 - f);
    let smooth_lobe = phase_rgb(mu, deposited_anisotropy(g) * sharpness);
    return mix(smooth_lobe, rest, unturned);
}

// Light of a fluence, as wide as its net flux (x, y, z) says, scattered into that lobe towards `travel`.
fn smooth_scattering(fluence: vec3f, x: vec3f, y: vec3f, z: vec3f, travel: vec3f, g: vec3f, unturned: vec3f) -> vec3f {
    let size = sqrt(x * x + y * y + z * z);
    let along = (x * travel.x + y * travel.y + z * travel.z) / max(size, vec3f(1e-20));
    let sharpness = min(size / max(fluence, vec3f(1e-20)), vec3f(1.0));
    return fluence * leaving_lobe(clamp(along, vec3f(-1.0), vec3f(1.0)), g, sharpness, unturned);
}

// What the reduced medium of similarity theory scatters, alike into all directions, of a `fluence` and of the mean
// radiance `indirect`; a channel that is not scattered forwards has `whole`.
fn reduced_emission(fluence: vec3f, indirect: vec3f, whole: vec3f, g: vec3f) -> vec3f {
    let scattered = (1.0 - g) * (fluence * PHASE_ISOTROPIC + indirect);
    return select(whole, scattered, g > vec3f(0.0));
}
