//! use media
//! use eye_ray

// The scattering coefficient that a source leaves out; 1 where it is whole.
fn source_weight(medium: i32, p: vec3f) -> vec3f {
    if (medium == -1) {
        return vec3f(1.0);
    }
    if (medium == -2) {
        return scattering_here();
    }
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        if (m == u32(medium)) {
            sum = media_density_here[m] * media_sigma_s[m];
        }
    }
    return sum;
}

// What every step needs of the buffers, which a software driver would read lane by lane each time.
var<private> own: MarchParams;
var<private> media_sigma_t: array<vec3f, MEDIA_COUNT>;     // sigma_t, m^-1
var<private> media_sigma_s: array<vec3f, MEDIA_COUNT>;     // sigma_s, m^-1
var<private> media_lit_scattering: array<vec3f, MEDIA_COUNT>;       // sigma_s where lattices light it, else 0
var<private> media_reduced_sigma_s: array<vec3f, MEDIA_COUNT>;        // of that, what similar even air scatters, m^-1
var<private> media_reduced_sigma_t: array<vec3f, MEDIA_COUNT>;      // sigma_t of similar air, m^-1
var<private> media_is_grid: array<bool, MEDIA_COUNT>;
// Optical depth of scattering from the eye to a step's middle.
var<private> eye_depth: f32;
// Of that way, m in air that lattices light.
var<private> eye_way: f32;
// Densities at a step's middle: asked once, they cost more than all else.
var<private> media_density_here: array<f32, MEDIA_COUNT>;

fn march_begin() {
    own = march;
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        media_sigma_t[m] = media[m].sigma_t;
        media_sigma_s[m] = media[m].sigma_t * media[m].albedo;
        media_lit_scattering[m] = f32(media[m].has_shafts) * media_sigma_s[m];
        media_reduced_sigma_s[m] = (1.0 - media[m].g) * media_lit_scattering[m];
        media_reduced_sigma_t[m] = media_sigma_t[m] - (media_lit_scattering[m] - media_reduced_sigma_s[m]);
        media_is_grid[m] = GRID_COUNT > 0u && media[m].kind == MEDIUM_GRID;
    }
}

// At t of the entered ray: p. Even air is known from its span.
fn look_around(p: vec3f, t: f32) {
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let is_in = medium_intervals[m].x <= t && t < medium_intervals[m].y;
        media_density_here[m] = select(0.0, 1.0, is_in);
        if (GRID_COUNT > 0u && media_is_grid[m]) {
            media_density_here[m] = medium_density(m, p);
        }
    }
}

fn shining_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        sum += media_density_here[m] * media_lit_scattering[m];
    }
    return sum;
}

fn scattering_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        sum += media_density_here[m] * media_sigma_s[m];
    }
    return sum;
}

// Optical depth of a step from t on, dt long.
fn depth_here(t: f32, dt: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let within = max(0.0, min(t + dt, medium_intervals[m].y) - max(t, medium_intervals[m].x));
        sum += media_sigma_t[m] * select(within, media_density_here[m] * dt, media_is_grid[m]);
    }
    return sum;
}

// Of lights one by one: what is scattered towards the eye at last, and what is scattered on as well.
struct ForwardLight { last: vec3f, on: vec3f }

// Of similar air; `scattered`: of the air's scattering, the mean of three channels.
struct SimilarDepth { depth: vec3f, scattered: f32, way: f32 }

fn similar_depth_here(t: f32, dt: f32) -> SimilarDepth {
    var sum = SimilarDepth(vec3f(0.0), 0.0, 0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let within = max(0.0, min(t + dt, medium_intervals[m].y) - max(t, medium_intervals[m].x));
        let length = select(within, media_density_here[m] * dt, media_is_grid[m]);
        sum.depth += media_reduced_sigma_t[m] * length;
        sum.scattered += dot(media_lit_scattering[m], vec3f(1.0 / 3.0)) * length;
        sum.way = max(sum.way, select(0.0, length, any(media_lit_scattering[m] > vec3f(0.0))));
    }
    return sum;
}

// The mean transmittance along a step of which `left` is let through.
fn mean_left(depth: vec3f, left: vec3f) -> vec3f {
    let series = 1.0 - depth * 0.5
        * (1.0 - depth * (1.0 / 3.0) * (1.0 - depth * 0.25 * (1.0 - depth * 0.2)));
    return select((1.0 - left) / depth, series, depth < vec3f(0.1));
}

// Of what a ray ends at, the light that air scatters on: similar air lets it through, the air itself
// does not. Of the sky what is scattered on but once is single scattering; surfaces' light comes out of
// a wide cone, as two bands of the cells there have it.
fn behind(eye: vec3f, ray: EyeRay, t: f32, T: vec3f, similar: vec3f) -> vec3f {
    let before = max(t - 0.5 * own.step, 0.0);
    let p = eye + before * ray.direction;
    look_around(p, before);
    let sources = emission_at(p, -ray.direction);       // enters the lattice
    let least = vec3f(1e-20);
    let once = T * log(max(similar, least) / max(T, least));
    let sky = max(similar - T - once, vec3f(0.0)) * skylit_at(p, -ray.direction);
    let surface = max(similar - T, vec3f(0.0)) * lattice_seen(p, -ray.direction);
    return select(surface, sky, ray.distance >= EYE_RAY_FAR) / max(shining_here(), least);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Marched {
    let texel = vec2u(position.xy);
    let ray = picked_ray(rays, texel, textureLoad(picked, vec2i(texel), 0).xy);
    march_begin();
    lattice_begin();
    let eye = rays.eye;
    let hull = media_enter(eye, ray.direction, ray.distance);
    var T = vec3f(1.0);
    var L = vec3f(0.0);
    var sky = vec3f(0.0);
    var similar = vec3f(1.0);       // what similar air lets through
    var forwards = vec3f(0.0);      // what it lets come of the lattices' light
    var in_bands = vec3f(0.0);      // what the air itself does, of two bands of it
    var most_left = 1.0;
    eye_depth = 0.0;
    eye_way = 0.0;
    var t = hull.x;
    let held = held_span(eye, ray.direction, hull);
    let longest = max(own.step, (held.y - held.x) / f32(own.max_steps));
    // Borders of media cut steps short and grids want steps of their own.
    let most = 2u * own.max_steps + GRID_COUNT * u32(MAX_COLUMN_STEPS);
    // Tested at its end: a software driver runs a body once more than a test before it lets through.
    var i = 0u;
    if (t < hull.y) {
        loop {
            let near = max(own.step * step_share(eye + t * ray.direction), longest);
            let here = held_step(t, held, near);
            let dt = min(media_step_limit(t, here), hull.y - t);
            let p = eye + (t + 0.5 * dt) * ray.direction;
            look_around(p, t + 0.5 * dt);
            let depth = depth_here(t, dt);
            let left = exp(-depth);
            let reached = T * dt * mean_left(depth, left);
            L += reached * emission_at(p, -ray.direction);
            sky += reached * skylit_at(p, -ray.direction);
            T *= left;
            most_left = max(T.r, max(T.g, T.b));
            if (IS_REDUCED_MEDIUM) {
                let even = similar_depth_here(t, dt);
                let even_left = exp(-even.depth);
                let evenly = similar * dt * mean_left(even.depth, even_left);
                eye_depth += 0.5 * even.scattered;
                // Of the sky's light that scattered once besides, what scattered on forwards.
                eye_way += even.way;
                let own_light = forward_light(p, -ray.direction, reached, evenly);
                forwards += evenly * similar_emission_at(p, -ray.direction) + own_light.on
                    + max(evenly - reached, vec3f(0.0)) * sky_even_at();
                in_bands += reached * lattice_seen(p, -ray.direction) + own_light.last;
                eye_depth += 0.5 * even.scattered;
                similar *= even_left;
                most_left = max(similar.r, max(similar.g, similar.b));
            }
            t += dt;
            i++;
            if (i >= most || t >= hull.y || most_left < own.cutoff) {
                break;
            }
        }
    }
    if (IS_REDUCED_MEDIUM && hull.x < hull.y) {
        // Near surfaces two bands know more of their light.
        let is_sky = ray.distance >= EYE_RAY_FAR;
        let all = forwards + behind(eye, ray, t, T, similar);
        L += mix(all, in_bands, select(similar, vec3f(0.0), is_sky));
    }
    return marched(vec4f(L, ray.distance), sky, T);
}
