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
            sum = air_here[m] * air[m].sigma_t * air[m].albedo;
        }
    }
    return sum;
}

// Densities at a step's middle: asked once, they cost more than all else.
var<private> air_here: array<f32, AIR_COUNT>;

fn look_around(p: vec3f) {
    for (var m = 0u; m < AIR_COUNT; m++) {
        air_here[m] = air_density(m, p);
    }
}

fn scattering_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        sum += air_here[m] * air[m].sigma_t * air[m].albedo;
    }
    return sum;
}

fn grid_extinction_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        if (air[m].kind == AIR_GRID) {
            sum += air_here[m] * air[m].sigma_t;
        }
    }
    return sum;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    let ray = picked_ray(rays, id.xy, textureLoad(picked, vec2i(id.xy), 0).xy);
    let hull = air_enter(rays.eye, ray.direction, ray.distance);
    var T = vec3f(1.0);
    var L = vec3f(0.0);
    var sky = vec3f(0.0);
    var t = hull.x;
    let longest = max(march.step, (hull.y - hull.x) / f32(march.max_steps));
    // Borders of media cut steps short and grids want steps of their own.
    let most = 2u * march.max_steps + AIR_GRIDS * u32(AIR_MAX_COLUMN_STEPS);
    // Tested at its end: a software driver runs a body once more than a test before it lets through.
    var i = 0u;
    if (t < hull.y) {
        loop {
            let here = max(march.step * step_share(rays.eye + t * ray.direction), longest);
            let dt = min(air_step_limit(t, here), hull.y - t);
            let p = rays.eye + (t + 0.5 * dt) * ray.direction;
            look_around(p);
            let depth = air_even_depth(t, t + dt) + dt * grid_extinction_here();
            let reached = T * dt * mean_transmittance_rgb(depth);
            L += reached * emission_at(p, -ray.direction);
            sky += reached * skylit_at(p, -ray.direction);
            T *= exp(-depth);
            t += dt;
            i++;
            if (i >= most || t >= hull.y || max(T.r, max(T.g, T.b)) < march.cutoff) {
                break;
            }
        }
    }
    textureStore(scattered, id.xy, vec4f(L, 1.0));
    store_skylit(id.xy, sky);
    textureStore(passed, id.xy, vec4f(T, 1.0));
}
