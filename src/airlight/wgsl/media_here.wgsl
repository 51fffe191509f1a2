// What media there are in the middle of a step of an eye ray, with their densities and coefficients.
//! use media_ray

// Copies of what every step reads; a CPU adapter would read the buffers lane by lane each time.
// Of many media there are none. m^-1 at density 1:
var<private> media_sigma_t: array<vec3f, COPIED_MEDIA>;
var<private> media_sigma_s: array<vec3f, COPIED_MEDIA>;
var<private> media_lit_scattering: array<vec3f, COPIED_MEDIA>;   // sigma_s where lattices light it, else 0
var<private> media_reduced_sigma_s: array<vec3f, COPIED_MEDIA>;  // of that, what the reduced medium scatters
var<private> media_reduced_sigma_t: array<vec3f, COPIED_MEDIA>;
var<private> media_is_grid: array<bool, COPIED_MEDIA>;
// Densities in the middle of a step, by places in the ray's list: looked up once, because they cost more than all
// else. Of many media the places of those that are there.
var<private> media_density_here: array<f32, MEDIA_COUNT>;
var<private> places_here: array<u32, MEDIA_COUNT>;
var<private> places_count: u32;
// What all media emit there, W m^-3 sr^-1.
var<private> emitted_here: vec3f;

fn media_here() -> u32 {
    if (!HAS_MEDIA_TREE) {
        return MEDIA_COUNT;
    }
    return places_count;
}

fn medium_here(j: u32) -> u32 {
    if (!HAS_MEDIA_TREE) {
        return j;
    }
    return places_here[j];
}

fn sigma_t_of(m: u32) -> vec3f {
    if (HAS_MEDIA_TREE) {
        return row_of_media(m).sigma_t;
    }
    return media_sigma_t[m];
}

fn sigma_s_of(m: u32) -> vec3f {
    if (HAS_MEDIA_TREE) {
        return row_of_media(m).sigma_t * row_of_media(m).albedo;
    }
    return media_sigma_s[m];
}

fn lit_scattering_of(m: u32) -> vec3f {
    if (HAS_MEDIA_TREE) {
        return has_shafts(m, false) * sigma_s_of(m);
    }
    return media_lit_scattering[m];
}

fn reduced_sigma_s_of(m: u32) -> vec3f {
    if (HAS_MEDIA_TREE) {
        return (1.0 - row_of_media(m).g) * lit_scattering_of(m);
    }
    return media_reduced_sigma_s[m];
}

fn reduced_sigma_t_of(m: u32) -> vec3f {
    if (HAS_MEDIA_TREE) {
        return row_of_media(m).sigma_t - row_of_media(m).g * lit_scattering_of(m);
    }
    return media_reduced_sigma_t[m];
}

fn is_grid(m: u32) -> bool {
    if (HAS_MEDIA_TREE) {
        return row_of_media(m).kind == MEDIUM_GRID;
    }
    return media_is_grid[m];
}

// Fill the copies.
fn media_copied() {
    for (var m = 0u; m < COPIED_MEDIA; m++) {
        media_sigma_t[m] = row_of_media(m).sigma_t;
        media_sigma_s[m] = row_of_media(m).sigma_t * row_of_media(m).albedo;
        media_lit_scattering[m] = has_shafts(m, false) * media_sigma_s[m];
        media_reduced_sigma_s[m] = (1.0 - row_of_media(m).g) * media_lit_scattering[m];
        media_reduced_sigma_t[m] =
            media_sigma_t[m] - (media_lit_scattering[m] - media_reduced_sigma_s[m]);
        media_is_grid[m] = GRID_COUNT > 0u && row_of_media(m).kind == MEDIUM_GRID;
    }
}

// Look up the densities at p, t of the entered ray. Homogeneous media are known by their intervals.
fn densities_at(p: vec3f, t: f32) {
    places_count = 0u;
    emitted_here = vec3f(0.0);
    for (var k = 0u; k < ray_media(); k++) {
        // Of many media those alone are listed that the point is in.
        let is_in = is_inside(k, t);
        media_density_here[k] = select(0.0, 1.0, is_in);
        if (HAS_MEDIA_TREE && !is_in) {
            continue;
        }
        // Grids are sampled, and tell how far they are empty.
        if (GRID_COUNT > 0u && is_grid(ray_medium(k))) {
            media_density_here[k] = grid_density_on_ray(k, p, t);
        }
        if (HAS_EMISSION && is_in) {
            let m = ray_medium(k);
            emitted_here += medium_emission(m, media_density_here[k], medium_coordinates(m, p));
        }
        if (HAS_MEDIA_TREE) {
            places_here[places_count] = k;
            places_count++;
        }
    }
}

// m^-1 of media that lattices light; next of all media.
fn lit_scattering_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var j = 0u; j < media_here(); j++) {
        let k = medium_here(j);
        sum += media_density_here[k] * lit_scattering_of(ray_medium(k));
    }
    return sum;
}

fn scattering_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var j = 0u; j < media_here(); j++) {
        let k = medium_here(j);
        sum += media_density_here[k] * sigma_s_of(ray_medium(k));
    }
    return sum;
}

// Metres of the ray's k-th medium at density 1 in a step from t on, dt long.
fn column_here(k: u32, t: f32, dt: f32) -> f32 {
    let within = max(0.0, min(t + dt, medium_intervals[k].y) - max(t, medium_intervals[k].x));
    return select(within, media_density_here[k] * dt, is_grid(ray_medium(k)));
}

// The optical depth of a step.
fn depth_here(t: f32, dt: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var j = 0u; j < media_here(); j++) {
        let k = medium_here(j);
        sum += sigma_t_of(ray_medium(k)) * column_here(k, t, dt);
    }
    return sum;
}
