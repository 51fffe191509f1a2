// All participating media of a scene. The including pass binds `GpuMedia.slots` and adds `GpuMedia.wgsl`,
// which declare `media`, MEDIA_COUNT, GRID_COUNT, medium_grid_texel and medium_noise. Points and lengths in
// metres; directions are unit vectors.
//! use medium
//! use phase
//! needs fn medium_grid_texel(grid: u32, uvw: vec3f) -> vec4f
//! needs fn media_emission_texel(at: vec3f) -> vec3f
//! needs fn medium_noise(at: vec3f) -> f32

const MEDIUM_BOX = 0u;
const MEDIUM_ELLIPSOID = 1u;
const MEDIUM_GRID = 2u;
const MAX_COLUMN_STEPS = 256.0;

// A point in the medium's own box, 0 to 1 on each axis.
fn medium_coordinates(m: u32, p: vec3f) -> vec3f {
    return (media[m].volume_from_world * vec4f(p, 1.0)).xyz;
}

// The ray parameters between which a ray is inside medium m; a miss has x > y.
fn medium_interval(m: u32, origin: vec3f, direction: vec3f) -> vec2f {
    let o = medium_coordinates(m, origin);
    let d = (media[m].volume_from_world * vec4f(direction, 0.0)).xyz;
    if (media[m].kind == MEDIUM_ELLIPSOID) {
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
    if (media[m].detail <= 0.0) {
        return 1.0;
    }
    let at = NOISE_ROTATION * (uvw * media[m].detail_periods);
    return exp(media[m].detail * medium_noise(at) + media[m].detail_bias);
}

// Density of medium m at a point, dimensionless; 0 outside the medium.
fn medium_density(m: u32, p: vec3f) -> f32 {
    let uvw = medium_coordinates(m, p);
    if (any(uvw < vec3f(0.0)) || any(uvw > vec3f(1.0))) {
        return 0.0;
    }
    if (GRID_COUNT > 0u && media[m].kind == MEDIUM_GRID) {
        return medium_grid_texel(media[m].grid, uvw).x * medium_detail(m, uvw);
    }
    let off = uvw - 0.5;
    return select(1.0, 0.0, media[m].kind == MEDIUM_ELLIPSOID && dot(off, off) > 0.25);
}

// What medium m emits at a point of its box, W m^-3 sr^-1; its density there, and the coordinates.
fn medium_emission(m: u32, density: f32, uvw: vec3f) -> vec3f {
    let count = media[m].emission_count;
    if (count.x > 0.0) {
        // Grids lie in one texture: each is filtered within its own box.
        let at = media[m].emission_first + clamp(uvw * count, vec3f(0.5), count - 0.5);
        return media[m].emission * media_emission_texel(at);
    }
    return media[m].emission * density;
}

// Emission of all media at a point, W m^-3 sr^-1.
fn media_emission(p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let uvw = medium_coordinates(m, p);
        if (all(uvw >= vec3f(0.0)) && all(uvw <= vec3f(1.0))) {
            sum += medium_emission(m, medium_density(m, p), uvw);
        }
    }
    return sum;
}

// Extinction of all media at a point, m^-1.
fn media_extinction(p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        sum += medium_density(m, p) * media[m].sigma_t;
    }
    return sum;
}

// Scattering coefficient of all media at a point, m^-1.
fn media_scattering(p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        sum += medium_density(m, p) * media[m].sigma_t * media[m].albedo;
    }
    return sum;
}

// Scattering times phase function of the media with shafts, m^-1 sr^-1; mu: the cosine between the two
// directions of travel.
fn media_phase_scattering(p: vec3f, mu: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        if (media[m].has_shafts != 0u) {
            sum += medium_density(m, p) * media[m].sigma_t * media[m].albedo
                * scattering_phase(mu, media[m].g);
        }
    }
    return sum;
}

// Integral of a grid's density over t0..t1 of a ray, m; steps of half a voxel.
fn medium_column(m: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> f32 {
    let steps = clamp(ceil((t1 - t0) / (0.5 * media[m].voxel)), 1.0, MAX_COLUMN_STEPS);
    let dt = (t1 - t0) / steps;
    var sum = 0.0;
    for (var i = 0.5; i < steps; i += 1.0) {
        let p = origin + (t0 + i * dt) * direction;
        sum += medium_grid_texel(media[m].grid, medium_coordinates(m, p)).x;
    }
    return sum * dt;
}

// Optical depth of all media on the interval t0..t1 of a ray.
fn media_optical_depth(origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let span = medium_interval(m, origin, direction);
        let a = max(span.x, t0);
        let b = min(span.y, t1);
        if (a < b) {
            var column = b - a;
            if (GRID_COUNT > 0u && media[m].kind == MEDIUM_GRID) {
                column = medium_column(m, origin, direction, a, b);
            }
            sum += media[m].sigma_t * column;
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

// Of one eye ray, the interval inside each medium, which `media_enter` finds once.
var<private> medium_intervals: array<vec2f, MEDIA_COUNT>;

// From the first to the last medium, in front of the eye, at most `reach`; a miss has x >= y.
fn media_enter(origin: vec3f, direction: vec3f, reach: f32) -> vec2f {
    var hull = vec2f(MEDIUM_FAR, -MEDIUM_FAR);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let span = medium_interval(m, origin, direction);
        let held = vec2f(max(span.x, 0.0), min(span.y, reach));
        medium_intervals[m] = select(vec2f(MEDIUM_FAR, -MEDIUM_FAR), held, held.x < held.y);
        hull = vec2f(min(hull.x, medium_intervals[m].x), max(hull.y, medium_intervals[m].y));
    }
    return hull;
}

// Optical depth of the media without grids on t0..t1 of the entered ray, exact.
fn homogeneous_depth(t0: f32, t1: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        if (GRID_COUNT == 0u || media[m].kind != MEDIUM_GRID) {
            let span = medium_intervals[m];
            sum += media[m].sigma_t * max(0.0, min(t1, span.y) - max(t0, span.x));
        }
    }
    return sum;
}

// Extinction of the grids at a point, m^-1.
fn grids_extinction(p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    if (GRID_COUNT > 0u) {
        for (var m = 0u; m < MEDIA_COUNT; m++) {
            if (media[m].kind == MEDIUM_GRID) {
                sum += medium_density(m, p) * media[m].sigma_t;
            }
        }
    }
    return sum;
}

// The next border of a medium beyond t, and the longest step that the grids around t allow.
fn media_step_limit(t: f32, step: f32) -> f32 {
    if (MEDIA_COUNT == 1u && GRID_COUNT == 0u) {
        return step;
    }
    var limit = step;
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let span = medium_intervals[m];
        let in_reach = span.x <= t && t < span.y;
        if (in_reach && media[m].kind == MEDIUM_GRID) {
            limit = min(limit, max(media[m].voxel, (span.y - span.x) / MAX_COLUMN_STEPS));
        }
        if (span.x > t) { limit = min(limit, span.x - t); }
        if (in_reach) { limit = min(limit, span.y - t); }
    }
    return max(limit, 2e-7 * t + 1e-7);
}
