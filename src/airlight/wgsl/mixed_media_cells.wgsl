// What is in a medium's cells together with all other media: coefficients add up; m^-1. The
// including pass binds `params` (MediumParams), `media` (MixedData, its own first) and `density`
// (array<f32>, [medium][cell], cell means). See wgsl/one_medium_cells.wgsl.
//! use delta_beam

fn absorbing(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        sum += density[m * params.cells + cell] * media[m].sigma_t * (1.0 - media[m].albedo);
    }
    return sum;
}

fn transporting(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let forward = media[m].albedo * media[m].g;
        sum += density[m * params.cells + cell] * media[m].sigma_t * (1.0 - forward);
    }
    return sum;
}

fn leaving_of(m: u32, cell: u32) -> vec3f {
    let turned = media[m].albedo * (1.0 - forward_share(media[m].g));
    return density[m * params.cells + cell] * media[m].sigma_t * turned;
}

// All that the medium itself scatters.
fn scattering_own(cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < OWN_PARTS; m++) {
        sum += density[m * params.cells + cell] * media[m].sigma_t * media[m].albedo;
    }
    return sum;
}

// Its mass, as the mean extinction of three channels.
fn mass_own(cell: u32) -> f32 {
    var sum = 0.0;
    for (var m = 0u; m < OWN_PARTS; m++) {
        sum += density[m * params.cells + cell] * dot(media[m].sigma_t, vec3f(1.0 / 3.0));
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
        sum += leaving_of(m, cell) * deposited_anisotropy(media[m].g);
    }
    return sum;
}
