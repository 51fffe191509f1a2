// What is in a medium's cells where no other one comes into them; m^-1. The including pass binds
// `params` (MediumParams) and `density` (array<f32>, cell means). See wgsl/mixed_media_cells.wgsl.
//! use delta_beam

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
