// What is in a medium's cells where no other one comes into them; m^-1. The including pass binds
// `params` (MediumParams) and `density` (array<f32>, cell means). See wgsl/mixed_media_cells.wgsl.
//! use delta_beam
//! use outgoing_light

fn absorbing(cell: u32) -> vec3f {
    return density[cell] * params.sigma_t * (1.0 - params.albedo);
}

// Scattering that turns light round, and absorption.
fn transporting(cell: u32) -> vec3f {
    let scattering = params.sigma_t * params.albedo;
    return density[cell] * (scattering * (1.0 - params.g) + params.sigma_t - scattering);
}

// Scattering that leaves beams, and the same times the direction that it keeps.
fn leaving_beams(cell: u32) -> vec3f {
    return params.sigma_t * params.albedo * (1.0 - forward_share(params.g)) * density[cell];
}

fn leaving_forward(cell: u32) -> vec3f {
    return leaving_beams(cell) * deposited_anisotropy(params.g);
}

// Of diffuse light, what leaves the medium or is absorbed before it is turned.
fn unturned() -> vec3f {
    let sigma = params.sigma_t * params.mean_density;
    let turning = sigma * params.albedo * (1.0 - params.g);
    return unturned_share(turning, sigma * (1.0 - params.albedo * params.g), params.largest_diffusivity);
}

// Directions of what leaves beams, and the light that scattering out of them makes of a fluence.
fn leaving_phase(cell: u32, mu: vec3f, sharpness: vec3f) -> vec3f {
    return leaving_lobe(mu, params.g, sharpness, unturned());
}

fn smooth_light(cell: u32, fluence: vec3f, x: vec3f, y: vec3f, z: vec3f, travel: vec3f) -> vec3f {
    return leaving_beams(cell) * smooth_scattering(fluence, x, y, z, travel, params.g, unturned());
}
