// All participating media of a scene. The including pass binds `GpuMedia.slots` and adds `GpuMedia.wgsl`,
// which declare `media`, MEDIA_COUNT, GRID_COUNT, densities_texel, densities_size and medium_noise. Points and
// lengths in metres; directions are unit vectors.
//! use medium
//! use media_tree
//! use phase
//! needs fn media_emission_texel(at: vec3f) -> vec3f
//! needs fn densities_texel(at: vec3f) -> vec2f
//! needs fn densities_size() -> vec3f
//! needs fn medium_noise(at: vec3f) -> f32

const MEDIUM_BOX = 0u;
const MEDIUM_ELLIPSOID = 1u;
const MEDIUM_GRID = 2u;
const SHAFTS_OF_ALL = 1u;
const SHAFTS_OF_LOCAL = 2u;
const MAX_COLUMN_STEPS = 256.0;

// A point in the medium's own box, 0 to 1 on each axis.
fn medium_coordinates(m: u32, p: vec3f) -> vec3f {
    return (row_of_media(m).volume_from_world * vec4f(p, 1.0)).xyz;
}

// A direction in the medium's own box, per metre.
fn volume_direction(m: u32, direction: vec3f) -> vec3f {
    return (row_of_media(m).volume_from_world * vec4f(direction, 0.0)).xyz;
}

// The ray parameters between which a ray is inside medium m; a miss has x > y.
fn medium_interval(m: u32, origin: vec3f, direction: vec3f) -> vec2f {
    let o = medium_coordinates(m, origin);
    let d = volume_direction(m, direction);
    if (row_of_media(m).kind == MEDIUM_ELLIPSOID) {
        let scale = length(d);
        return ray_sphere_interval(o, d / scale, vec3f(0.5), 0.5) / scale;
    }
    return ray_box_interval(o, d, vec3f(0.0), vec3f(1.0));
}

// The factor of mean 1 by which noise finer than a grid's voxels multiplies its density. The axes of the noise
// are rotated, so that its repeats do not line up with the grid.
const NOISE_ROTATION = mat3x3f(
    0.6667, -0.3333, 0.6667, 0.6667, 0.6667, -0.3333, -0.3333, 0.6667, 0.6667);

fn medium_detail(m: u32, uvw: vec3f) -> f32 {
    if (row_of_media(m).detail <= 0.0) {
        return 1.0;
    }
    let at = NOISE_ROTATION * (uvw * row_of_media(m).detail_periods);
    return exp(row_of_media(m).detail * medium_noise(at) + row_of_media(m).detail_bias);
}

// Voxels of medium m, trilinear: density, and the distance to the next that are not empty (maths/empty_voxels.py).
// Grids lie in one texture: each is filtered within its own box.
fn medium_voxels(m: u32, uvw: vec3f) -> vec2f {
    if (GRID_COUNT <= 1u) {
        return densities_texel(uvw);
    }
    let count = row_of_media(m).grid_count;
    let at = clamp(uvw * count, vec3f(0.5), count - 0.5) + row_of_media(m).grid_first;
    return densities_texel(at / densities_size());
}

// Density of a grid at a point, 0 outside its box, and the distance as of `medium_voxels`.
fn medium_grid_matter(m: u32, p: vec3f) -> vec2f {
    let uvw = medium_coordinates(m, p);
    if (any(uvw < vec3f(0.0)) || any(uvw > vec3f(1.0))) {
        return vec2f(0.0);
    }
    return medium_voxels(m, uvw) * vec2f(medium_detail(m, uvw), 1.0);
}

// Density of medium m at a point, dimensionless; 0 outside the medium.
fn medium_density(m: u32, p: vec3f) -> f32 {
    return medium_density_at(m, medium_coordinates(m, p));
}

// The same at coordinates in its box.
fn medium_density_at(m: u32, uvw: vec3f) -> f32 {
    if (any(uvw < vec3f(0.0)) || any(uvw > vec3f(1.0))) {
        return 0.0;
    }
    if (GRID_COUNT > 0u && row_of_media(m).kind == MEDIUM_GRID) {
        return medium_voxels(m, uvw).x * medium_detail(m, uvw);
    }
    let off = uvw - 0.5;
    return select(1.0, 0.0, row_of_media(m).kind == MEDIUM_ELLIPSOID && dot(off, off) > 0.25);
}

// What medium m emits at a point of its box, W m^-3 sr^-1; its density there, and the coordinates.
fn medium_emission(m: u32, density: f32, uvw: vec3f) -> vec3f {
    let count = row_of_media(m).emission_count;
    if (count.x > 0.0) {
        // Grids lie in one texture: each is filtered within its own box.
        let at = row_of_media(m).emission_first + clamp(uvw * count, vec3f(0.5), count - 0.5);
        return row_of_media(m).emission * media_emission_texel(at);
    }
    return row_of_media(m).emission * density;
}

struct MediaCoefficients {
    extinction: vec3f,      // m^-1
    scattering: vec3f,      // m^-1
    forward: vec3f,         // m^-1, that times the mean cosine
}

// What all media together have at a point.
fn media_coefficients(p: vec3f) -> MediaCoefficients {
    var sum = MediaCoefficients(vec3f(0.0), vec3f(0.0), vec3f(0.0));
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_near(node, p, 0.0);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped) { continue; }
        let m = visit.medium;
        let extinction = medium_density(m, p) * row_of_media(m).sigma_t;
        let scattering = extinction * row_of_media(m).albedo;
        sum.extinction += extinction;
        sum.scattering += scattering;
        sum.forward += scattering * row_of_media(m).g;
    }
    return sum;
}

// Whether shafts draw what medium m scatters once of a local light, or of another; 1 or 0.
fn has_shafts(m: u32, is_local: bool) -> f32 {
    return select(0.0, 1.0, row_of_media(m).shafts == SHAFTS_OF_ALL
        || (is_local && row_of_media(m).shafts == SHAFTS_OF_LOCAL));
}

// Scattering times phase function of the media with shafts, m^-1 sr^-1; mu: the cosine between the two
// directions of travel.
fn media_phase_scattering(p: vec3f, mu: f32, sharpness: f32, is_local: bool) -> vec3f {
    var sum = vec3f(0.0);
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_near(node, p, 0.0);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped) { continue; }
        let m = visit.medium;
        if (has_shafts(m, is_local) > 0.0) {
            sum += medium_density(m, p) * row_of_media(m).sigma_t * row_of_media(m).albedo
                * scattering_phase(mu, sharpness * row_of_media(m).g);
        }
    }
    return sum;
}

// Integral of a grid's density over t0..t1 of a ray, m; steps of half a voxel.
fn medium_column(m: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> f32 {
    let steps = clamp(ceil((t1 - t0) / (0.5 * row_of_media(m).voxel)), 1.0, MAX_COLUMN_STEPS);
    let dt = (t1 - t0) / steps;
    var sum = 0.0;
    for (var i = 0.5; i < steps; i += 1.0) {
        let p = origin + (t0 + i * dt) * direction;
        sum += medium_voxels(m, medium_coordinates(m, p)).x;
    }
    return sum * dt;
}

// Optical depth of all media on the interval t0..t1 of a ray.
fn media_optical_depth(origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> vec3f {
    var sum = vec3f(0.0);
    let ray = walked_ray(origin, direction, t1);
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_on_ray(node, ray);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped) { continue; }
        let m = visit.medium;
        // The part of the interval inside; a grid's density is integrated along it.
        let span = medium_interval(m, origin, direction);
        let a = max(span.x, t0);
        let b = min(span.y, t1);
        if (a < b) {
            var column = b - a;
            if (GRID_COUNT > 0u && row_of_media(m).kind == MEDIUM_GRID) {
                column = medium_column(m, origin, direction, a, b);
            }
            sum += row_of_media(m).sigma_t * column;
        }
    }
    return sum;
}

// Transmittance of all media between two points.
fn media_transmittance(a: vec3f, b: vec3f) -> vec3f {
    let path = b - a;
    let reach = length(path);
    if (reach <= 0.0) {
        return vec3f(1.0);
    }
    return exp(-media_optical_depth(a, path / reach, 0.0, reach));
}
