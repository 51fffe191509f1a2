// What is in a medium's cells together with all other media: coefficients add up; m^-1. The
// including pass binds `params` (MediumParams), `media` (MixedData, its own first) and `density`
// (array<f32>, [medium][cell], cell means). See wgsl/one_medium_cells.wgsl.
//! use delta_beam
//! use outgoing_light

fn absorbing(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum += density[m * params.cells + cell] * row_of_media(m).sigma_t * (1.0 - row_of_media(m).albedo);
    }
    return sum;
}

fn transporting(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let forward = row_of_media(m).albedo * row_of_media(m).g;
        sum += density[m * params.cells + cell] * row_of_media(m).sigma_t * (1.0 - forward);
    }
    return sum;
}

fn leaving_of(m: u32, cell: u32) -> vec3f {
    let turned = row_of_media(m).albedo * (1.0 - forward_share(row_of_media(m).g));
    return density[m * params.cells + cell] * row_of_media(m).sigma_t * turned;
}

// All that the medium itself scatters.
fn scattering_own(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < OWN_PARTS; m++) {
        sum += density[m * params.cells + cell] * row_of_media(m).sigma_t * row_of_media(m).albedo;
    }
    return sum;
}

// Its mass, as the mean extinction of three channels.
fn mass_own(cell: u32) -> f32 {
    var sum = 0.0;
    for (var m = 0u; m < OWN_PARTS; m++) {
        sum += density[m * params.cells + cell] * dot(row_of_media(m).sigma_t, vec3f(1.0 / 3.0));
    }
    return sum;
}

fn leaving_beams(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum += leaving_of(m, cell);
    }
    return sum;
}

fn leaving_forward(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum += leaving_of(m, cell) * deposited_anisotropy(row_of_media(m).g);
    }
    return sum;
}

fn unturned() -> vec3f {
    var turning = vec3f(0.0);
    var either = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let sigma = row_of_media(m).sigma_t * row_of_media(m).mean_density * row_of_media(m).overlap;
        turning += sigma * row_of_media(m).albedo * (1.0 - row_of_media(m).g);
        either += sigma * (1.0 - row_of_media(m).albedo * row_of_media(m).g);
    }
    return unturned_share(turning, either, params.largest_diffusivity);
}

fn leaving_phase(cell: u32, mu: vec3f, sharpness: vec3f) -> vec3f {
    let share = unturned();
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum += leaving_of(m, cell) * leaving_lobe(mu, row_of_media(m).g, sharpness, share);
    }
    return sum / max(leaving_beams(cell), vec3f(1e-30));
}

fn smooth_light(cell: u32, fluence: vec3f, x: vec3f, y: vec3f, z: vec3f, travel: vec3f) -> vec3f {
    let share = unturned();
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum += leaving_of(m, cell) * smooth_scattering(fluence, x, y, z, travel, row_of_media(m).g, share);
    }
    return sum;
}
