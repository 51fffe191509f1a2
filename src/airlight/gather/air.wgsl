// What media do to a segment of a path, from cells of a lattice as they are, else as the reduced media of similarity
// theory: the light that they scatter into it, and their transmittance. Where it leaves the scene that is of the media themselves:
// light of the sky that they only scatter forwards is on surfaces already (beams.wgsl). So is what they emit: media are
// lights (area/glowing.py), which send to surfaces and cells; mirrored rays alone see them glow, as far as their
// surface is too smooth for highlights of those lights.
//! use media_here
//! use tone
//! use glow_share
//! needs fn emission_at(p: vec3f, travel: vec3f) -> vec3f
//! needs fn lattice_begin()

const FARTHEST = 1e9;       // m
const GRID_STEPS = 12.0;    // through the whole of a grid, at least

var<private> own: MarchParams;

// The step from t on: no border of a medium within it, and short enough for the grids around.
fn air_step(t: f32, step: f32) -> f32 {
    if (MEDIA_COUNT == 1u && GRID_COUNT == 0u) {
        return step;
    }
    var limit = step;
    for (var k = 0u; k < ray_media(); k++) {
        let span = medium_intervals[k];
        let is_in = is_inside(k, t);
        if (is_in && is_grid(ray_medium(k))) {
            limit = min(limit, (span.y - span.x) / GRID_STEPS);
        }
        limit = min(limit, select(FARTHEST, span.x - t, span.x > t));
        limit = min(limit, select(FARTHEST, span.y - t, is_in));
    }
    return max(limit, 2e-7 * t + 1e-7);
}

// Of the reduced medium, or of the lattices' media themselves; of a volume that is a source, where those count as
// reduced ones and scatter forwards.
fn met_sigma_t(m: u32) -> vec3f {
    let sigma_t = select(reduced_sigma_t_of(m), sigma_t_of(m), params.has_lobes != 0u);
    if (params.is_reduced == 0u) {
        return sigma_t;
    }
    return sigma_t - max(row_of_media(m).g, vec3f(0.0)) * (sigma_s_of(m) - lit_scattering_of(m));
}

// Optical depth of the reduced media in a step.
fn reduced_depth_here(t: f32, dt: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var j = 0u; j < media_here(); j++) {
        let k = medium_here(j);
        sum += met_sigma_t(ray_medium(k)) * column_here(k, t, dt);
    }
    return sum;
}

struct Air {
    light: vec3f,       // W m^-2 sr^-1
    inverse_m: f32,     // of how far away it is scattered, the mean by its luminance
    passed: vec3f,
}

fn air_along(start: vec4f, direction: vec3f, reach: f32) -> Air {
    let origin = start.xyz;
    let shown = select(0.0, unpacked_glow_share(start.w), params.shows_glow != 0u);
    var out = Air(vec3f(0.0), 0.0, vec3f(1.0));
    var passed = vec3f(1.0);            // by the media themselves
    let hull = media_enter(origin, direction, reach);
    var t = hull.x;
    if (hull.x >= hull.y) {
        return out;
    }
    // Steps through all media on the ray, each with source and extinction at its middle.
    let step = max(own.step, (hull.y - hull.x) / f32(own.max_steps));
    let most = 2u * own.max_steps + (GRID_COUNT + MEDIA_COUNT) * u32(GRID_STEPS);
    var i = 0u;
    loop {
        let dt = min(air_step(t, step), hull.y - t);
        let p = origin + (t + 0.5 * dt) * direction;
        densities_at(p, t + 0.5 * dt);
        let depth = reduced_depth_here(t, dt);
        let light = shown * emitted_here + emission_at(p, -direction);
        let arriving = out.passed * dt * mean_transmittance_rgb(depth) * light;
        out.light += arriving;
        out.inverse_m += luminance(arriving) / (t + 0.5 * dt);
        out.passed *= exp(-depth);
        passed *= exp(-depth_here(t, dt));
        t += dt;
        i++;
        if (i >= most || t >= hull.y || all(out.passed < vec3f(own.cutoff))) { break; }
    }
    // The light's mean distance; what lies beyond the media comes through the media themselves.
    out.inverse_m /= max(luminance(out.light), 1e-20);
    out.passed = select(out.passed, passed, reach >= FARTHEST);
    return out;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.rays) {
        return;
    }
    own = march;
    media_copied();
    lattice_begin();
    let at = vec2u(id.x, select(id.y, id.y % params.reduced.y, params.segment == 0u));
    let start = textureLoad(starts, at, 0);
    let end = textureLoad(reached, id.xy, 0);
    var found = Air(vec3f(0.0), 0.0, vec3f(1.0));
    if (start.w > 0.0) {
        // Where a ray left the scene, its direction.
        let offset = select(end.xyz, end.xyz - start.xyz, end.w > 0.0);
        let reach = select(FARTHEST, length(offset), end.w > 0.0);
        found = air_along(start, normalize(offset), reach);
    }
    let row = 2u * (id.y * params.reduced.x + id.x);
    air[row] = vec4f(found.light, found.inverse_m);
    air[row + 1u] = vec4f(found.passed, 0.0);
}
