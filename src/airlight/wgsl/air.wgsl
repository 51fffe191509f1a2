// All media of a scene. The including pass binds Air.slots and adds Air.wgsl, which declare `air`,
// AIR_COUNT, AIR_GRIDS and air_grid. Points and lengths in metres; directions are unit.
//! use medium
//! use phase

const AIR_BOX = 0u;
const AIR_ELLIPSOID = 1u;
const AIR_GRID = 2u;
const AIR_MAX_COLUMN_STEPS = 256.0;

fn air_place(m: u32, p: vec3f) -> vec3f {
    return (air[m].volume_from_world * vec4f(p, 1.0)).xyz;
}

// The ray parameters between which it is inside medium m; a miss has x > y.
fn air_span(m: u32, origin: vec3f, direction: vec3f) -> vec2f {
    let o = air_place(m, origin);
    let d = (air[m].volume_from_world * vec4f(direction, 0.0)).xyz;
    if (air[m].kind == AIR_ELLIPSOID) {
        let scale = length(d);
        return ray_sphere_interval(o, d / scale, vec3f(0.5), 0.5) / scale;
    }
    return ray_box_interval(o, d, vec3f(0.0), vec3f(1.0));
}

// What noise finer than a grid's voxels multiplies its density by; its mean is 1. The noise's own
// axes are turned, so that its repeats do not line up with the grid.
const AIR_NOISE_TURN = mat3x3f(
    0.6667, -0.3333, 0.6667, 0.6667, 0.6667, -0.3333, -0.3333, 0.6667, 0.6667);

fn air_detail(m: u32, place: vec3f) -> f32 {
    if (air[m].detail <= 0.0) {
        return 1.0;
    }
    let at = AIR_NOISE_TURN * (place * air[m].detail_periods);
    return exp(air[m].detail * air_noise_at(at) + air[m].detail_bias);
}

// Dimensionless; 0 outside the medium.
fn air_density(m: u32, p: vec3f) -> f32 {
    let place = air_place(m, p);
    if (any(place < vec3f(0.0)) || any(place > vec3f(1.0))) {
        return 0.0;
    }
    if (AIR_GRIDS > 0u && air[m].kind == AIR_GRID) {
        return air_grid(air[m].grid, place).x * air_detail(m, place);
    }
    let off = place - 0.5;
    return select(1.0, 0.0, air[m].kind == AIR_ELLIPSOID && dot(off, off) > 0.25);
}

fn air_extinction(p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        sum += air_density(m, p) * air[m].sigma_t;
    }
    return sum;
}

fn air_scattering(p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        sum += air_density(m, p) * air[m].sigma_t * air[m].albedo;
    }
    return sum;
}

// The share scattered by the cosine mu between the two directions of travel, m^-1 sr^-1.
fn air_phase_scattering(p: vec3f, mu: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        if (air[m].has_shafts != 0u) {
            sum += air_density(m, p) * air[m].sigma_t * air[m].albedo
                * henyey_greenstein_rgb(mu, air[m].g);
        }
    }
    return sum;
}

// Integral of a grid's density over t0..t1 of a ray, m; steps of half a voxel.
fn air_column(m: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> f32 {
    let steps = clamp(ceil((t1 - t0) / (0.5 * air[m].voxel)), 1.0, AIR_MAX_COLUMN_STEPS);
    let dt = (t1 - t0) / steps;
    var sum = 0.0;
    for (var i = 0.5; i < steps; i += 1.0) {
        sum += air_grid(air[m].grid, air_place(m, origin + (t0 + i * dt) * direction)).x;
    }
    return sum * dt;
}

// Of the stretch t0..t1 of a ray.
fn air_optical_depth(origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        let span = air_span(m, origin, direction);
        let a = max(span.x, t0);
        let b = min(span.y, t1);
        if (a < b) {
            var column = b - a;
            if (AIR_GRIDS > 0u && air[m].kind == AIR_GRID) {
                column = air_column(m, origin, direction, a, b);
            }
            sum += air[m].sigma_t * column;
        }
    }
    return sum;
}

// Between two points.
fn air_transmittance(a: vec3f, b: vec3f) -> vec3f {
    let way = b - a;
    let reach = length(way);
    if (reach <= 0.0) {
        return vec3f(1.0);
    }
    return exp(-air_optical_depth(a, way / reach, 0.0, reach));
}

// One eye ray asked many times: `air_enter` finds its spans once.
var<private> air_spans: array<vec2f, AIR_COUNT>;

// From the first to the last medium, in front of the eye, at most `reach`; a miss has x >= y.
fn air_enter(origin: vec3f, direction: vec3f, reach: f32) -> vec2f {
    var hull = vec2f(MEDIUM_FAR, -MEDIUM_FAR);
    for (var m = 0u; m < AIR_COUNT; m++) {
        let span = air_span(m, origin, direction);
        let held = vec2f(max(span.x, 0.0), min(span.y, reach));
        air_spans[m] = select(vec2f(MEDIUM_FAR, -MEDIUM_FAR), held, held.x < held.y);
        hull = vec2f(min(hull.x, air_spans[m].x), max(hull.y, air_spans[m].y));
    }
    return hull;
}

// Optical depth of the media without grids on t0..t1 of the entered ray, exact.
fn air_even_depth(t0: f32, t1: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        if (AIR_GRIDS == 0u || air[m].kind != AIR_GRID) {
            let span = air_spans[m];
            sum += air[m].sigma_t * max(0.0, min(t1, span.y) - max(t0, span.x));
        }
    }
    return sum;
}

// Extinction of the grids at a point, m^-1.
fn air_grid_extinction(p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    if (AIR_GRIDS > 0u) {
        for (var m = 0u; m < AIR_COUNT; m++) {
            if (air[m].kind == AIR_GRID) {
                sum += air_density(m, p) * air[m].sigma_t;
            }
        }
    }
    return sum;
}

// The next border of a medium beyond t, and the longest step that the grids around t allow.
fn air_step_limit(t: f32, step: f32) -> f32 {
    if (AIR_COUNT == 1u && AIR_GRIDS == 0u) {
        return step;
    }
    var limit = step;
    for (var m = 0u; m < AIR_COUNT; m++) {
        let span = air_spans[m];
        let in_reach = span.x <= t && t < span.y;
        if (in_reach && air[m].kind == AIR_GRID) {
            limit = min(limit, max(air[m].voxel, (span.y - span.x) / AIR_MAX_COLUMN_STEPS));
        }
        if (span.x > t) { limit = min(limit, span.x - t); }
        if (in_reach) { limit = min(limit, span.y - t); }
    }
    return max(limit, 2e-7 * t + 1e-7);
}
