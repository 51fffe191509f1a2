// How all media attenuate an ordinate's light on its path to a cell of one of them. The including pass
// binds `params` (MediumParams), `media` (MixedData, its own first), `passed` (pop/light/paths.py) and
// `inter_medium` (vec4f, [block][cell], pop/exchange/irradiance.py). See wgsl/one_medium_beams.wgsl.
//! use delta_beam

// In the own box.
fn passed_of(m: u32, n: u32, cell: u32) -> f32 {
    let part = select(m + 1u, 0u, m == 0u);
    return passed[(part * params.ordinate_count + n) * params.cells + cell];
}

// Beyond it: there what is scattered forwards spreads sideways, and comes from blocks.
fn depth_beyond(n: u32, cell: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 1u; m < MEDIA; m++) {
        let part = MEDIA + m;
        sum += passed[(part * params.ordinate_count + n) * params.cells + cell]
            * row_of_media(m).sigma_t;
    }
    return sum;
}

fn true_depth(n: u32, cell: u32) -> vec3f {
    var sum = depth_beyond(n, cell);
    for (var m = 0u; m < MEDIA; m++) {
        sum += passed_of(m, n, cell) * row_of_media(m).sigma_t;
    }
    return sum;
}

fn reduced_depth(n: u32, cell: u32) -> vec3f {
    var sum = depth_beyond(n, cell);
    for (var m = 0u; m < MEDIA; m++) {
        let loss = beam_loss(row_of_media(m).g, row_of_media(m).albedo);
        sum += loss * passed_of(m, n, cell) * row_of_media(m).sigma_t;
    }
    return sum;
}

fn quasi_forward_cosine(n: u32, cell: u32) -> vec3f {
    var often = vec3f(0.0);
    var cosines = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let share = forward_share(row_of_media(m).g) * row_of_media(m).albedo;
        let times = share * passed_of(m, n, cell) * row_of_media(m).sigma_t;
        often += times;
        cosines += times * (1.0 + 2.0 * row_of_media(m).g) / 3.0;
    }
    return forward_cosine(often, cosines / max(often, vec3f(1e-20)));
}

fn inter_medium_irradiance(n: u32, cell: u32) -> vec3f {
    let first = params.ordinate_count - BLOCKS;
    if (BLOCKS == 0u || n < first) {
        return vec3f(1.0);
    }
    return inter_medium[(n - first) * params.cells + cell].rgb;
}

fn mean_loss() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let loss = row_of_media(m).sigma_t * beam_loss(row_of_media(m).g, row_of_media(m).albedo);
        sum += loss * row_of_media(m).mean_density;
    }
    return sum;
}

fn scattering_near(n: u32, cell: u32, r: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA; m++) {
        let filled = passed_of(m, n, cell) / r;
        let share = filled * min(1.0, filled / max(row_of_media(m).mean_density, 1e-30));
        let turned = row_of_media(m).albedo * (1.0 - forward_share(row_of_media(m).g));
        sum += row_of_media(m).sigma_t * turned * share;
    }
    return sum;
}
