// Marches an eye ray through the media, front to back. Source and extinction are constant within a
// step, the integral over it is exact (Billeter2012 section 4.3). Where lattices hold the light of
// reduced media (similarity theory), that light is marched through the reduced media: their
// transmittance stands for light that is scattered forwards on its way to the eye.
//! use media
//! use eye_ray
//! needs fn emission_at(p: vec3f, travel: vec3f) -> vec3f
//! needs fn forward_light(p: vec3f, travel: vec3f, reached: vec3f, reduced_reached: vec3f) -> ForwardLight
//! needs fn lattice_begin()
//! needs fn lattice_interval(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f
//! needs fn lattice_two_bands(p: vec3f, travel: vec3f) -> vec3f
//! needs fn sky_reduced_at() -> vec3f
//! needs fn step_share(p: vec3f) -> f32
//! needs fn marched(scattered: vec4f, sky: vec3f, T: vec3f) -> Marched
//! needs fn reduced_emission_at(p: vec3f, travel: vec3f) -> vec3f
//! needs fn skylit_at(p: vec3f, travel: vec3f) -> vec3f
//! needs fn step_length(t: f32, lattice: vec2f, near: f32) -> f32

// The scattering coefficient that a source leaves out; 1 where it is an emission.
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

// Copies of what every step reads; a CPU adapter would read the buffers lane by lane each time.
// m^-1 at density 1:
var<private> own: MarchParams;
var<private> media_sigma_t: array<vec3f, MEDIA_COUNT>;
var<private> media_sigma_s: array<vec3f, MEDIA_COUNT>;
var<private> media_lit_scattering: array<vec3f, MEDIA_COUNT>;   // sigma_s where lattices light it, else 0
var<private> media_reduced_sigma_s: array<vec3f, MEDIA_COUNT>;  // of that, what the reduced medium scatters
var<private> media_reduced_sigma_t: array<vec3f, MEDIA_COUNT>;
var<private> media_is_grid: array<bool, MEDIA_COUNT>;
// Optical depth of scattering from the eye to the middle of a step.
var<private> eye_depth: f32;
// Metres of that path in media that lattices light.
var<private> eye_path: f32;
// Densities in the middle of a step: looked up once, because they cost more than all else.
var<private> media_density_here: array<f32, MEDIA_COUNT>;
// What all media emit there, W m^-3 sr^-1.
var<private> emitted_here: vec3f;

// Fill the copies.
fn march_begin() {
    own = march;
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        media_sigma_t[m] = media[m].sigma_t;
        media_sigma_s[m] = media[m].sigma_t * media[m].albedo;
        media_lit_scattering[m] = f32(media[m].has_shafts) * media_sigma_s[m];
        media_reduced_sigma_s[m] = (1.0 - media[m].g) * media_lit_scattering[m];
        media_reduced_sigma_t[m] =
            media_sigma_t[m] - (media_lit_scattering[m] - media_reduced_sigma_s[m]);
        media_is_grid[m] = GRID_COUNT > 0u && media[m].kind == MEDIUM_GRID;
    }
}

// Look up the densities at p, t of the entered ray. Homogeneous media are known by their intervals.
fn densities_at(p: vec3f, t: f32) {
    emitted_here = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let is_in = medium_intervals[m].x <= t && t < medium_intervals[m].y;
        media_density_here[m] = select(0.0, 1.0, is_in);
        if (GRID_COUNT > 0u && media_is_grid[m]) {
            media_density_here[m] = medium_density(m, p);
        }
        if (HAS_EMISSION && is_in) {
            emitted_here += medium_emission(m, media_density_here[m], medium_coordinates(m, p));
        }
    }
}

// m^-1 of media that lattices light; next of all media.
fn lit_scattering_here() -> vec3f {
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

// Metres of medium m at density 1 in a step from t on, dt long.
fn column_here(m: u32, t: f32, dt: f32) -> f32 {
    let within = max(0.0, min(t + dt, medium_intervals[m].y) - max(t, medium_intervals[m].x));
    return select(within, media_density_here[m] * dt, media_is_grid[m]);
}

// The optical depth of a step.
fn depth_here(t: f32, dt: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        sum += media_sigma_t[m] * column_here(m, t, dt);
    }
    return sum;
}

// Light of lights one by one: scattered for the last time, towards the eye; and scattered on
// towards it as well.
struct ForwardLight { last: vec3f, on: vec3f }

// A step through the reduced media: optical depth, the depth of the media's scattering (the mean of
// three channels), and metres in media that lattices light.
struct ReducedStep { depth: vec3f, scattered: f32, path: f32 }

fn reduced_step_here(t: f32, dt: f32) -> ReducedStep {
    var sum = ReducedStep(vec3f(0.0), 0.0, 0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let length = column_here(m, t, dt);
        sum.depth += media_reduced_sigma_t[m] * length;
        sum.scattered += dot(media_lit_scattering[m], vec3f(1.0 / 3.0)) * length;
        sum.path = max(sum.path, select(0.0, length, any(media_lit_scattering[m] > vec3f(0.0))));
    }
    return sum;
}

// The mean transmittance along a step, whose whole transmittance is T.
fn mean_transmittance_of(depth: vec3f, T: vec3f) -> vec3f {
    let series = 1.0 - depth * 0.5
        * (1.0 - depth * (1.0 / 3.0) * (1.0 - depth * 0.25 * (1.0 - depth * 0.2)));
    return select((1.0 - T) / depth, series, depth < vec3f(0.1));
}

// Light of what a ray ends at that media scatter forwards to the eye: the reduced media transmit
// it, the media do not. Of the sky, what is scattered on once only is single scattering. The light
// of surfaces comes from a wide cone, which two bands of the cells in front of them hold.
fn light_behind(eye: vec3f, ray: EyeRay, t: f32, T: vec3f, T_reduced: vec3f) -> vec3f {
    let before = max(t - 0.5 * own.step, 0.0);
    let p = eye + before * ray.direction;
    densities_at(p, before);
    let sources = emission_at(p, -ray.direction);       // enters the lattice
    let least = vec3f(1e-20);
    let once = T * log(max(T_reduced, least) / max(T, least));
    let sky = max(T_reduced - T - once, vec3f(0.0)) * skylit_at(p, -ray.direction);
    let surface = max(T_reduced - T, vec3f(0.0)) * lattice_two_bands(p, -ray.direction);
    return select(surface, sky, ray.distance >= EYE_RAY_FAR) / max(lit_scattering_here(), least);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Marched {
    // The ray, and where it is in media.
    let texel = vec2u(position.xy);
    let ray = picked_ray(rays, texel, textureLoad(picked, vec2i(texel), 0).xy);
    march_begin();
    lattice_begin();
    let eye = rays.eye;
    let hull = media_enter(eye, ray.direction, ray.distance);
    // Radiance and transmittance so far; of reduced media: their transmittance, the light of
    // lattices that they transmit, and what the media themselves transmit of its two bands.
    var T = vec3f(1.0);
    var L = vec3f(0.0);
    var sky = vec3f(0.0);
    var T_reduced = vec3f(1.0);
    var L_reduced = vec3f(0.0);
    var L_two_bands = vec3f(0.0);
    var T_most = 1.0;
    eye_depth = 0.0;
    eye_path = 0.0;
    var t = hull.x;
    let in_lattice = lattice_interval(eye, ray.direction, hull);
    let longest = max(own.step, (in_lattice.y - in_lattice.x) / f32(own.max_steps));
    // Borders of media cut steps short, and grids want steps of their own.
    let most = 2u * own.max_steps + GRID_COUNT * u32(MAX_COLUMN_STEPS);
    // The loop is tested at its end: a CPU adapter runs a body once more than a test before it lets
    // through.
    var i = 0u;
    if (t < hull.y) {
        loop {
            // A step: as long as the cells there, and no border of a medium within it.
            let near = max(own.step * step_share(eye + t * ray.direction), longest);
            let wanted = step_length(t, in_lattice, near);
            let dt = min(media_step_limit(t, wanted), hull.y - t);
            let p = eye + (t + 0.5 * dt) * ray.direction;
            densities_at(p, t + 0.5 * dt);
            // What media emit and scatter in it, times the mean transmittance to the eye.
            let depth = depth_here(t, dt);
            let T_step = exp(-depth);
            let reached = T * dt * mean_transmittance_of(depth, T_step);
            L += reached * (emitted_here + emission_at(p, -ray.direction));
            sky += reached * skylit_at(p, -ray.direction);
            T *= T_step;
            T_most = max(T.r, max(T.g, T.b));
            if (IS_REDUCED_MEDIUM) {
                // The same through the reduced media, half of the step's scattering before its
                // middle.
                let reduced = reduced_step_here(t, dt);
                let T_reduced_step = exp(-reduced.depth);
                let reduced_reached =
                    T_reduced * dt * mean_transmittance_of(reduced.depth, T_reduced_step);
                eye_depth += 0.5 * reduced.scattered;
                eye_path += reduced.path;
                let own_light = forward_light(p, -ray.direction, reached, reduced_reached);
                // Beside single scattering of the sky, and what media emit, what is scattered
                // forwards of both.
                L_reduced += reduced_reached * reduced_emission_at(p, -ray.direction) + own_light.on
                    + max(reduced_reached - reached, vec3f(0.0))
                    * (sky_reduced_at() + emitted_here);
                L_two_bands += reached * lattice_two_bands(p, -ray.direction) + own_light.last;
                eye_depth += 0.5 * reduced.scattered;
                T_reduced *= T_reduced_step;
                T_most = max(T_reduced.r, max(T_reduced.g, T_reduced.b));
            }
            t += dt;
            i++;
            if (i >= most || t >= hull.y || T_most < own.cutoff) {
                break;
            }
        }
    }
    if (IS_REDUCED_MEDIUM && hull.x < hull.y) {
        // Close to surfaces two bands represent their light better.
        let is_sky = ray.distance >= EYE_RAY_FAR;
        let all = L_reduced + light_behind(eye, ray, t, T, T_reduced);
        L += mix(all, L_two_bands, select(T_reduced, vec3f(0.0), is_sky));
    }
    return marched(vec4f(L, ray.distance), sky, T);
}
