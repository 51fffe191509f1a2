// Marches an eye ray through the media, front to back. Source and extinction are constant within a
// step, the integral over it is exact (Billeter2012 section 4.3). Where lattices hold the light of
// reduced media (similarity theory), that light is marched through the reduced media: their
// transmittance stands for light that is scattered forwards on its way to the eye.
//! use media_here
//! use end_plane
//! use eye_ray
//! use packed_shares
//! needs fn emission_at(p: vec3f, travel: vec3f) -> vec3f
//! needs fn forward_light(p: vec3f, travel: vec3f, reached: vec3f, reduced_reached: vec3f) -> vec3f
//! needs fn lattice_begin()
//! needs fn lattice_obliqueness(n: vec3f) -> f32
//! needs fn lattice_interval(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f
//! needs fn lattice_two_bands(p: vec3f, travel: vec3f) -> vec3f
//! needs fn sky_reduced_at() -> vec3f
//! needs fn step_share(p: vec3f) -> f32
//! needs fn marched(scattered: vec4f, sky: vec3f, T: vec3f) -> Marched
//! needs fn reduced_emission_at(p: vec3f, travel: vec3f) -> vec3f
//! needs fn skylit_at(p: vec3f, travel: vec3f) -> vec3f
//! needs fn step_length(t: f32, lattice: vec2f, near: f32) -> f32

// A copy: a CPU adapter would read the buffer lane by lane each time.
var<private> own: MarchParams;
// Optical depth of scattering from the eye to the middle of a step.
var<private> eye_depth: f32;
// Metres of that path in media that lattices light.
var<private> eye_path: f32;

// A step through the reduced media: optical depth, the depth of the media's scattering (the mean of
// three channels), and metres in media that lattices light.
struct ReducedStep { depth: vec3f, scattered: f32, path: f32 }

fn reduced_step_here(t: f32, dt: f32) -> ReducedStep {
    var sum = ReducedStep(vec3f(0.0), 0.0, 0.0);
    for (var j = 0u; j < media_here(); j++) {
        let k = medium_here(j);
        let m = ray_medium(k);
        let length = column_here(k, t, dt);
        let lit = lit_scattering_of(m);
        sum.depth += reduced_sigma_t_of(m) * length;
        sum.scattered += dot(lit, vec3f(1.0 / 3.0)) * length;
        sum.path = max(sum.path, select(0.0, length, any(lit > vec3f(0.0))));
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
    _ = emission_at(p, -ray.direction);     // enters the lattice, which the sky and two bands are read of
    let least = vec3f(1e-20);
    let once = T * log(max(T_reduced, least) / max(T, least));
    let sky = max(T_reduced - T - once, vec3f(0.0)) * skylit_at(p, -ray.direction);
    let surface = max(T_reduced - T, vec3f(0.0)) * lattice_two_bands(p, -ray.direction);
    return select(surface, sky, ray.distance >= EYE_RAY_FAR) / max(lit_scattering_here(), least);
}

const LEAST_JUMP = 1e-3;  // of the distance: smaller differences of neighbours are one

// From the end of a ray to those of its neighbours along `axis`: more to the one that ends at the more similar
// distance, alike where they are, so that an image does not depend on how it is turned.
fn to_neighbours(texel: vec2i, axis: vec2i, ray: EyeRay) -> vec3f {
    let below = max(texel - axis, vec2i(0));
    let above = min(texel + axis, vec2i(textureDimensions(picked)) - 1);
    let before = picked_ray(rays, vec2u(below), textureLoad(picked, below, 0).xy);
    let after = picked_ray(rays, vec2u(above), textureLoad(picked, above, 0).xy);
    let jumps = abs(vec2f(before.distance, after.distance) / ray.distance - 1.0) + LEAST_JUMP;
    let shares = vec2f(jumps.y * jumps.y, jumps.x * jumps.x) / dot(jumps, jumps);
    let end = ray.distance * ray.direction;
    let forth = after.distance * after.direction - end;
    let back = end - before.distance * before.direction;
    return select(mix(back, forth, shares.y), back + forth, all(below == texel) || all(above == texel));
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Marched {
    // The ray, and where it is in media.
    let texel = vec2u(position.xy);
    let ray = picked_ray(rays, texel, textureLoad(picked, vec2i(texel), 0).xy);
    own = march;
    media_copied();
    lattice_begin();
    let eye = rays.eye;
    let facing = end_normal(ray.direction, ray.distance, EYE_RAY_FAR, to_neighbours(vec2i(texel), vec2i(1, 0), ray),
        to_neighbours(vec2i(texel), vec2i(0, 1), ray));
    let plane = EndPlane(eye + ray.distance * ray.direction, facing.xyz,
        CELLS_BEFORE * own.step * facing.w * lattice_obliqueness(facing.xyz));
    let hull = media_enter(eye, ray.direction, ray.distance);
    // Radiance and transmittance so far; of reduced media: their transmittance, the light of
    // lattices that they transmit, and what the media themselves transmit of its two bands.
    var T = vec3f(1.0);
    var L = vec3f(0.0);
    var glow = vec3f(0.0);
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
            // A cell that a surface cuts holds the light of both of its sides: before the one that
            // the ray ends at, light is read a cell before it, or before its plane if that is oblique.
            let read_at = min(t + 0.5 * dt, max(ray.distance - own.step, hull.x));
            let q = moved_before(plane, eye + read_at * ray.direction);
            // What media emit and scatter in it, times the mean transmittance to the eye.
            let depth = depth_here(t, dt);
            let T_step = exp(-depth);
            let reached = T * dt * mean_transmittance_of(depth, T_step);
            L += reached * (emitted_here + emission_at(q, -ray.direction));
            glow += reached * emitted_here;
            sky += reached * skylit_at(q, -ray.direction);
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
                // Beside single scattering of the sky what is scattered forwards of it. What media emit
                // is among lights.
                let forward = max(reduced_reached - reached, vec3f(0.0));
                L_reduced += reduced_reached * reduced_emission_at(q, -ray.direction)
                    + forward_light(q, -ray.direction, reached, reduced_reached)
                    + forward * sky_reduced_at();
                L_two_bands += reached * lattice_two_bands(q, -ray.direction);
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
    // Beside the light how far the ray goes; in grids, where none asks for that, which share of it is emitted.
    let shares = packed_shares(glow / max(L, vec3f(1e-30)));
    return marched(vec4f(L, select(ray.distance, shares, HAS_EMISSION && GRID_COUNT > 0u)), sky, T);
}
