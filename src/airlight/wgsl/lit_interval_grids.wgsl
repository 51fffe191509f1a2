// Radiance towards the eye from a lit interval of an eye ray through density grids: what lit_interval.wgsl is for
// homogeneous media. The ray is cut into steps that do not depend on what is lit. Media are homogeneous within a
// step, so a lit piece of it has its exact share of the step's light.
// The including pass adds lit_interval_wgsl (media/shafts/shadow_rays.py). Loops are tested at their ends: CPU
// adapters run a body once more than a test before it passes.
//! use media_ray
//! use media_light
//! use lights_in_media

const OPAQUE_DEPTH = 14.0;    // optical depth beyond which nothing is seen

// The step that the ray has been followed to; before the first, its end is negative.
var<private> step_begin: f32;
var<private> step_end: f32;
var<private> step_depth: vec3f;     // optical depth from the eye to the step's begin
var<private> step_sigma: vec3f;     // extinction, m^-1
var<private> step_sent: vec3f;      // of a directional light to the eye, m^-1 sr^-1
// The media of the step, and their densities; few media are all listed.
var<private> step_media: array<u32, MEDIA_COUNT>;
var<private> step_density: array<f32, MEDIA_COUNT>;
var<private> step_media_count: u32;
// Of a directional light, sr^-1; and the cosine between its light and the direction to the eye.
var<private> parallel_phases: array<vec3f, COPIED_MEDIA>;
var<private> towards_eye: f32;
// Optical depth towards the light at the step's begin and end; for local lights per metre of the path,
// which has no kink where the ray passes the light.
var<private> step_light: mat2x3f;
var<private> media_hull: vec2f;

// Once per eye ray and light.
fn prepare_lit_intervals(light: LightData, origin: vec3f, direction: vec3f) {
    media_hull = vec2f(MEDIUM_FAR, 0.0);
    for (var k = 0u; k < ray_media(); k++) {
        media_hull = vec2f(min(media_hull.x, medium_intervals[k].x), max(media_hull.y, medium_intervals[k].y));
    }
    towards_eye = -dot(light.direction, direction);
    for (var m = 0u; m < COPIED_MEDIA; m++) {
        parallel_phases[m] = has_shafts(m, false) * scattering_phase(towards_eye, row_of_media(m).g);
    }
    step_end = -1.0;
}

// Copied where media are few.
fn parallel_phase(m: u32) -> vec3f {
    if (HAS_MEDIA_TREE) {
        return has_shafts(m, false) * scattering_phase(towards_eye, row_of_media(m).g);
    }
    return parallel_phases[m];
}

fn media_in_step() -> u32 {
    if (!HAS_MEDIA_TREE) {
        return MEDIA_COUNT;
    }
    return step_media_count;
}

// Borders of media end steps. The whole ray is cut into GRID_STEPS of them, and so is its interval in a grid, but
// not finer than voxels.
fn grid_step_length(t: f32) -> f32 {
    var limit = (media_hull.y - media_hull.x) / GRID_STEPS;
    for (var k = 0u; k < ray_media(); k++) {
        let m = ray_medium(k);
        let span = medium_intervals[k];
        let is_in = span.x <= t && t < span.y;
        let fine = max(row_of_media(m).voxel, (span.y - span.x) / GRID_STEPS);
        limit = min(limit, select(MEDIUM_FAR, fine, is_in && row_of_media(m).kind == MEDIUM_GRID));
        limit = min(limit, select(MEDIUM_FAR, span.y - t, is_in));
        limit = min(limit, select(MEDIUM_FAR, span.x - t, span.x > t));
    }
    return max(limit, 2e-7 * t + 1e-7);
}

// Advances by a step; the first has no length.
fn next_step(light: LightData, index: u32, origin: vec3f, direction: vec3f) {
    // From where the last one ended, with the optical depth up to there.
    let is_first = step_end < 0.0;
    step_depth = select(step_depth + (step_end - step_begin) * step_sigma, vec3f(0.0), is_first);
    step_begin = select(step_end, media_hull.x, is_first);
    step_end = step_begin + select(grid_step_length(step_begin), 0.0, is_first);
    // The media at its middle stand for the whole step.
    let p = origin + 0.5 * (step_begin + step_end) * direction;
    step_sigma = vec3f(0.0);
    step_sent = vec3f(0.0);
    step_media_count = 0u;
    for (var k = 0u; k < ray_media(); k++) {
        let m = ray_medium(k);
        if (HAS_MEDIA_TREE && !is_inside(k, 0.5 * (step_begin + step_end))) {
            continue;
        }
        let density = medium_density(m, p);
        let extinction = density * row_of_media(m).sigma_t;
        step_sigma += extinction;
        step_sent += extinction * row_of_media(m).albedo * parallel_phase(m);
        step_media[step_media_count] = m;
        step_density[step_media_count] = density;
        step_media_count++;
    }
    // Towards the light from its end; its begin is where the last one ended.
    let end = origin + step_end * direction;
    let is_local = light.kind != LIGHT_DIRECTIONAL;
    let path = select(1.0, max(media_light_path(light, end).w, 1e-9), is_local);
    step_light = mat2x3f(step_light[1], media_light_depth(light, index, end) / path);
}

// A directional light on a piece of the step: optical depth along light and eye ray is linear.
fn parallel_piece(a: f32, b: f32) -> vec3f {
    let length = step_end - step_begin;
    let slope = step_sigma + (step_light[1] - step_light[0]) / length;
    let near = step_depth + step_light[0] + (a - step_begin) * slope;
    let more = (b - a) * slope;
    return step_sent * (b - a) * exp(-min(near, near + more)) * mean_transmittance_rgb(abs(more));
}

// Radiance scattered to the eye at a point of the step, per unit of length and irradiance of a point.
fn sent_by(seen: SeenLight, t: f32) -> vec3f {
    let along = (t - step_begin) / (step_end - step_begin);
    let towards = seen.reach * mix(step_light[0], step_light[1], along);
    var sum = vec3f(0.0);
    for (var j = 0u; j < media_in_step(); j++) {
        let m = step_media[j];
        sum += has_shafts(m, true) * step_density[j] * row_of_media(m).sigma_t * row_of_media(m).albedo
            * scattering_phase(seen.mu, seen.sharpness * row_of_media(m).g);
    }
    return seen.gain * sum * exp(-step_depth - (t - step_begin) * step_sigma - towards);
}

// A local light at one node, an angle of `on`.
fn local_node(light: LightData, origin: vec3f, direction: vec3f, on: SeenInterval, x: f32) -> vec3f {
    // Where the ray passes close by, the angle says little.
    let t = clamp(on.t_near + on.h * tan(x), step_begin, step_end);
    let away = origin + t * direction - light.position;
    let squared = on.h * on.h + (t - on.t_near) * (t - on.t_near);
    return sent_by(seen_light(light, away, -direction, sqrt(squared), -sin(x)), t);
}

// Two or more Gauss-Legendre nodes in the angle that the piece is seen under from the light.
fn local_piece(light: LightData, origin: vec3f, direction: vec3f, a: f32, b: f32) -> vec3f {
    let on = seen_interval(light, origin, direction, a, b);
    let pieces = u32(clamp(ceil((on.x1 - on.x0) / 0.4), 1.0, 8.0));
    let half = 0.5 * (on.x1 - on.x0) / f32(pieces);
    let off = 0.5773502691896258 * half;
    var sum = vec3f(0.0);
    var i = 0u;
    loop {
        let x = on.x0 + f32(2u * i + 1u) * half;
        sum += local_node(light, origin, direction, on, x - off)
            + local_node(light, origin, direction, on, x + off);
        i++;
        if (i >= pieces) { break; }
    }
    return sum * half / on.h;
}

// The lit interval t0..t1: radiance, W m^-2 sr^-1. Intervals come in order along the ray, or the ray is followed
// from its begin again.
fn lit_interval(
    light: LightData, index: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    if (t0 < step_begin) {
        step_end = -1.0;
    }
    // Step by step: the lit part of each, until nothing more is lit, there, or seen.
    var sum = vec3f(0.0);
    loop {
        let a = max(t0, step_begin);
        let b = min(t1, step_end);
        if (a < b) {
            if (HAS_LOCAL && light.kind != LIGHT_DIRECTIONAL) {
                sum += local_piece(light, origin, direction, a, b);
            } else if (HAS_DIRECTIONAL) {
                sum += parallel_piece(a, b);
            }
        }
        if (step_end >= min(t1, media_hull.y) || least(step_depth) > OPAQUE_DEPTH) { break; }
        next_step(light, index, origin, direction);
    }
    return sum * light.color;
}

fn least(v: vec3f) -> f32 {
    return min(v.x, min(v.y, v.z));
}

// The whole ray is followed.
fn visible_interval(hull: vec2f) -> vec2f {
    return hull;
}
