//! use air
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
    for (var m = 0u; m < AIR_COUNT; m++) {
        if (m == u32(medium)) {
            sum = air_here[m] * air_scatters[m];
        }
    }
    return sum;
}

// What every step needs of the buffers, which a software driver would read lane by lane each time.
var<private> own: MarchParams;
var<private> air_extincts: array<vec3f, AIR_COUNT>;     // sigma_t, m^-1
var<private> air_scatters: array<vec3f, AIR_COUNT>;     // sigma_s, m^-1
var<private> air_shines: array<vec3f, AIR_COUNT>;       // sigma_s where lattices light it, else 0
var<private> air_is_grid: array<bool, AIR_COUNT>;
// Densities at a step's middle: asked once, they cost more than all else.
var<private> air_here: array<f32, AIR_COUNT>;

fn march_begin() {
    own = march;
    for (var m = 0u; m < AIR_COUNT; m++) {
        air_extincts[m] = air[m].sigma_t;
        air_scatters[m] = air[m].sigma_t * air[m].albedo;
        air_shines[m] = f32(air[m].has_shafts) * air_scatters[m];
        air_is_grid[m] = AIR_GRIDS > 0u && air[m].kind == AIR_GRID;
    }
}

// At t of the entered ray: p. Even air is known from its span.
fn look_around(p: vec3f, t: f32) {
    for (var m = 0u; m < AIR_COUNT; m++) {
        let is_in = air_spans[m].x <= t && t < air_spans[m].y;
        air_here[m] = select(0.0, 1.0, is_in);
        if (AIR_GRIDS > 0u && air_is_grid[m]) {
            air_here[m] = air_density(m, p);
        }
    }
}

fn scattering_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        sum += air_here[m] * air_scatters[m];
    }
    return sum;
}

// Optical depth of a step from t on, dt long.
fn depth_here(t: f32, dt: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        let within = max(0.0, min(t + dt, air_spans[m].y) - max(t, air_spans[m].x));
        sum += air_extincts[m] * select(within, air_here[m] * dt, air_is_grid[m]);
    }
    return sum;
}

// The mean transmittance along a step of which `left` is let through.
fn mean_left(depth: vec3f, left: vec3f) -> vec3f {
    let series = 1.0 - depth / 2.0
        * (1.0 - depth / 3.0 * (1.0 - depth / 4.0 * (1.0 - depth / 5.0)));
    return select((1.0 - left) / depth, series, depth < vec3f(0.1));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    let ray = picked_ray(rays, id.xy, textureLoad(picked, vec2i(id.xy), 0).xy);
    march_begin();
    lattice_begin();
    let eye = rays.eye;
    let hull = air_enter(eye, ray.direction, ray.distance);
    var T = vec3f(1.0);
    var L = vec3f(0.0);
    var sky = vec3f(0.0);
    var t = hull.x;
    let held = held_span(eye, ray.direction, hull);
    let longest = max(own.step, (held.y - held.x) / f32(own.max_steps));
    // Borders of media cut steps short and grids want steps of their own.
    let most = 2u * own.max_steps + AIR_GRIDS * u32(AIR_MAX_COLUMN_STEPS);
    // Tested at its end: a software driver runs a body once more than a test before it lets through.
    var i = 0u;
    if (t < hull.y) {
        loop {
            let near = max(own.step * step_share(eye + t * ray.direction), longest);
            let here = held_step(t, held, near);
            let dt = min(air_step_limit(t, here), hull.y - t);
            let p = eye + (t + 0.5 * dt) * ray.direction;
            look_around(p, t + 0.5 * dt);
            let depth = depth_here(t, dt);
            let left = exp(-depth);
            let reached = T * dt * mean_left(depth, left);
            L += reached * emission_at(p, -ray.direction);
            sky += reached * skylit_at(p, -ray.direction);
            T *= left;
            t += dt;
            i++;
            if (i >= most || t >= hull.y || max(T.r, max(T.g, T.b)) < own.cutoff) {
                break;
            }
        }
    }
    textureStore(scattered, id.xy, vec4f(L, ray.distance));
    store_skylit(id.xy, sky);
    textureStore(passed, id.xy, vec4f(T, 1.0));
}
