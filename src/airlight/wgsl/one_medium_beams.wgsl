// How one medium attenuates an ordinate's light on its path to a cell. The including pass binds `params`
// (MediumParams) and `passed` (pop/light/paths.py). See wgsl/mixed_media_beams.wgsl.
//! use delta_beam

fn true_depth(n: u32, cell: u32) -> vec3f {
    return passed[n * params.cells + cell] * params.sigma_t;
}

// What a beam that keeps part of what it scatters is attenuated by.
fn reduced_depth(n: u32, cell: u32) -> vec3f {
    return beam_loss(params.g, params.albedo) * true_depth(n, cell);
}

// Mean cosine of light that was scattered, but forwards only.
fn quasi_forward_cosine(n: u32, cell: u32) -> vec3f {
    return quasi_forward_anisotropy(params.g, params.albedo, true_depth(n, cell));
}

// Of an ordinate that is another medium's light, what arrives.
fn inter_medium_irradiance(n: u32, cell: u32) -> vec3f {
    return vec3f(1.0);
}

// Of beams, where the medium is as dense as in its mean; m^-1.
fn mean_loss() -> vec3f {
    return params.sigma_t * beam_loss(params.g, params.albedo) * params.mean_density;
}

// Scattering out of beams on the path from a local light at distance r, m^-1, as far as the path is filled.
fn scattering_near(n: u32, cell: u32, r: f32) -> vec3f {
    let filled = passed[n * params.cells + cell] / r;
    let share = filled * min(1.0, filled / max(params.mean_density, 1e-30));
    return params.sigma_t * params.albedo * (1.0 - forward_share(params.g)) * share;
}
