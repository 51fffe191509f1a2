// One eye ray through all media: which of them it meets, where, and how far its steps may go.
//! use media

// Of one eye ray, the media that it meets, which `media_enter` finds once, and its interval inside each. Few media
// are all listed in their order.
var<private> medium_intervals: array<vec2f, MEDIA_COUNT>;
var<private> listed_media: array<u32, MEDIA_COUNT>;
var<private> listed_count: u32;
// Of grids, how many voxels a metre of the ray crosses, along the axis where those are most; and to where on the
// ray the density that was looked up last is known to be 0.
var<private> voxels_per_m: array<f32, MEDIA_COUNT>;
var<private> empty_until: array<f32, MEDIA_COUNT>;

// What is free around a point is less by so many voxels than the distance there; see maths/empty_voxels.py.
const EMPTY_REACH = 2.25;

fn ray_media() -> u32 {
    if (!HAS_MEDIA_TREE) {
        return MEDIA_COUNT;
    }
    return listed_count;
}

// The k-th of them.
fn ray_medium(k: u32) -> u32 {
    if (!HAS_MEDIA_TREE) {
        return k;
    }
    return listed_media[k];
}

// From the first to the last medium, in front of the eye, at most `reach`; a miss has x >= y.
fn media_enter(origin: vec3f, direction: vec3f, reach: f32) -> vec2f {
    var hull = vec2f(MEDIUM_FAR, -MEDIUM_FAR);
    let ray = walked_ray(origin, direction, reach);
    var k = 0u;
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_on_ray(node, ray);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped) { continue; }
        let m = visit.medium;
        // The part of the ray in this medium, and how fast the ray crosses its voxels.
        let span = medium_interval(m, origin, direction);
        let held = vec2f(max(span.x, 0.0), min(span.y, reach));
        medium_intervals[k] = select(vec2f(MEDIUM_FAR, -MEDIUM_FAR), held, held.x < held.y);
        if (GRID_COUNT > 0u) {
            let crossed = abs(volume_direction(m, direction)) * row_of_media(m).grid_count;
            // A grid that glows may do so where it holds nothing.
            voxels_per_m[k] = select(max(max(crossed.x, crossed.y), crossed.z), MEDIUM_FAR,
                row_of_media(m).emission_count.x > 0.0);
            empty_until[k] = 0.0;
        }
        hull = vec2f(min(hull.x, medium_intervals[k].x), max(hull.y, medium_intervals[k].y));
        if (HAS_MEDIA_TREE) {
            listed_media[k] = m;
        }
        k += select(1u, 0u, HAS_MEDIA_TREE && held.x >= held.y);
    }
    listed_count = k;
    return hull;
}

// The density of the ray's k-th medium, a grid, at p, t of the ray.
fn grid_density_on_ray(k: u32, p: vec3f, t: f32) -> f32 {
    let matter = medium_grid_matter(ray_medium(k), p);
    empty_until[k] = t + max(matter.y - EMPTY_REACH, 0.0) / voxels_per_m[k];
    return matter.x;
}

// Optical depth of the media without grids on t0..t1 of the entered ray, exact.
fn homogeneous_depth(t0: f32, t1: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var k = 0u; k < ray_media(); k++) {
        let m = ray_medium(k);
        if (GRID_COUNT == 0u || row_of_media(m).kind != MEDIUM_GRID) {
            let span = medium_intervals[k];
            sum += row_of_media(m).sigma_t * max(0.0, min(t1, span.y) - max(t0, span.x));
        }
    }
    return sum;
}

// Extinction of the grids at the point p, t of the entered ray, m^-1.
fn grids_extinction(p: vec3f, t: f32) -> vec3f {
    var sum = vec3f(0.0);
    if (GRID_COUNT > 0u) {
        for (var k = 0u; k < ray_media(); k++) {
            let m = ray_medium(k);
            if (row_of_media(m).kind == MEDIUM_GRID && is_inside(k, t)) {
                sum += grid_density_on_ray(k, p, t) * row_of_media(m).sigma_t;
            }
        }
    }
    return sum;
}

// Whether t of the entered ray is in its k-th medium.
fn is_inside(k: u32, t: f32) -> bool {
    return medium_intervals[k].x <= t && t < medium_intervals[k].y;
}

// How long a step from t on may be: to the next border of a medium, as short as the grids around t want it, and no
// longer than `step` where there is anything; what is known to be empty is one step.
fn media_step_limit(t: f32, step: f32) -> f32 {
    if (MEDIA_COUNT == 1u && GRID_COUNT == 0u) {
        return step;
    }
    var limit = MEDIUM_FAR;
    var is_empty = true;
    for (var k = 0u; k < ray_media(); k++) {
        let span = medium_intervals[k];
        let in_reach = span.x <= t && t < span.y;
        let m = ray_medium(k);
        // In a grid a voxel, or all that is known to be empty.
        if (in_reach && row_of_media(m).kind == MEDIUM_GRID) {
            let voxel = max(row_of_media(m).voxel, (span.y - span.x) / MAX_COLUMN_STEPS);
            let free = empty_until[k] - t;
            limit = min(limit, max(voxel, free));
            is_empty = is_empty && free > voxel;
        } else {
            is_empty = is_empty && !in_reach;
        }
        // No step goes across a border.
        if (span.x > t) { limit = min(limit, span.x - t); }
        if (in_reach) { limit = min(limit, span.y - t); }
    }
    // Rounding must not make a step of nothing.
    return max(select(min(limit, step), limit, is_empty), 2e-7 * t + 1e-7);
}
