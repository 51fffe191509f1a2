// Radiance towards the eye from a lit stretch of an eye ray that `air_enter` has entered. The
// including pass adds run_wgsl (media/shafts/shafts.py), which says what cannot occur: software drivers
// run both sides of every branch, and bodies of loops once before a test at their head.
//! use air
//! use air_light
//! use light_reach

// Exit of the light's straight way back out of the one medium's box: distance at the eye, and its
// slope along the ray, per axis; the least one counts.
var<private> run_exit: vec3f;
var<private> run_slope: vec3f;
// Of the one medium, copied: software drivers read buffers lane by lane once anything has branched.
var<private> run_sigma_t: vec3f;        // m^-1
var<private> run_sent: vec3f;           // of a parallel light to the eye, m^-1 sr^-1
var<private> run_has_shafts: bool;
var<private> run_is_inside: bool;       // whether a lamp is in the one medium itself

// Once per eye ray and light.
fn run_prepare(light: LightData, origin: vec3f, direction: vec3f) {
    let phase = henyey_greenstein_rgb(-dot(light.direction, direction), air[0].g);
    run_sigma_t = air[0].sigma_t;
    run_sent = air[0].albedo * run_sigma_t * phase;
    run_has_shafts = air[0].has_shafts != 0u;
    run_is_inside = AIR_COUNT == 1u && air_density(0u, light.position) > 0.0;
    let o = air_place(0u, origin);
    let d = (air[0].volume_from_world * vec4f(direction, 0.0)).xyz;
    let back = -(air[0].volume_from_world * vec4f(light.direction, 0.0)).xyz;
    let still = abs(back) < vec3f(1e-12);
    let inverse = 1.0 / select(back, vec3f(1.0), still);
    run_exit = select((select(vec3f(0.0), vec3f(1.0), back > vec3f(0.0)) - o) * inverse,
        vec3f(MEDIUM_FAR), still);
    run_slope = select(-d * inverse, vec3f(0.0), still);
}

fn least(v: vec3f) -> f32 {
    return min(v.x, min(v.y, v.z));
}

// The light's way through the box to the ray at t, m.
fn light_way(t: f32) -> f32 {
    return max(least(run_exit + t * run_slope), 0.0);
}

// Where beyond t the light's way next changes the face it came in by; at most `end`.
fn next_face(t: f32, end: f32) -> f32 {
    let crossing = (run_exit.yzx - run_exit) / (run_slope - run_slope.yzx);
    let beyond = select(vec3f(end), crossing, crossing > vec3f(t * 1.000001 + 1e-6));
    return min(end, least(beyond));
}

// Parallel light in one box of even air, closed form: between changes of face the optical depth
// along light and eye ray is linear. Source: Billeter2012 eq. 1.
fn parallel_run(t0: f32, t1: f32) -> vec3f {
    let sigma_t = run_sigma_t;
    let entry = air_spans[0].x;
    var sum = vec3f(0.0);
    var t = t0;
    var piece = 0u;
    loop {
        let end = next_face(t, t1);
        let a = sigma_t * (t - entry + light_way(t));
        let b = sigma_t * (end - entry + light_way(end));
        sum += exp(-min(a, b)) * (end - t) * mean_transmittance_rgb(abs(b - a));
        t = end;
        piece++;
        if (piece >= 4u || t >= t1) { break; }
    }
    return sum * run_sent;
}

// What a point of the ray sends to the eye per unit of length and irradiance, of medium m.
fn sent_by(light: LightData, index: u32, m: u32, p: vec3f, t: f32, mu: f32, way: f32) -> vec3f {
    var depth: vec3f;
    if (AIR_COUNT == 1u && run_is_inside) {
        depth = air[0].sigma_t * (t - air_spans[0].x + way);
    } else {
        depth = air_even_depth(0.0, t) + air_light_depth(light, index, p);
    }
    return air[m].sigma_t * air[m].albedo * henyey_greenstein_rgb(mu, air[m].g) * exp(-depth);
}

// A lamp at one node: X = atan(t/h) removes 1/r^2 (Kulla and Fajardo 2012).
fn lamp_node(
    light: LightData, index: u32, m: u32, origin: vec3f, direction: vec3f, t_near: f32, h: f32,
    x: f32,
) -> vec3f {
    let t = t_near + h * tan(x);
    let p = origin + t * direction;
    var sent = sent_by(light, index, m, p, t, -sin(x), h / cos(x));
    if (light.kind == LIGHT_SPOT) {
        sent *= spot_fade(light, normalize(p - light.position));
    }
    return sent;
}

// Pieces of a lamp's run: narrow in angle where the phase function is sharp, and thin in depth.
fn lamp_pieces(m: u32, angle: f32, length_m: f32) -> u32 {
    let g = max(abs(air[m].g.x), max(abs(air[m].g.y), abs(air[m].g.z)));
    let sigma = max(air[m].sigma_t.x, max(air[m].sigma_t.y, air[m].sigma_t.z));
    let widest = mix(0.9, 0.2, saturate(g));
    return u32(clamp(ceil(max(angle / widest, sigma * length_m / 3.0)), 1.0, 12.0));
}

fn lamp_run(
    light: LightData, index: u32, m: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    let geometry = ray_light_geometry(origin, direction, light.position);
    let t_near = -geometry.y;
    let h = max(geometry.x, 1e-4 * max(abs(t0 - t_near), abs(t1 - t_near)) + 1e-9);
    let x0 = atan((t0 - t_near) / h);
    let x1 = atan((t1 - t_near) / h);
    let pieces = lamp_pieces(m, x1 - x0, t1 - t0);
    let half = 0.5 * (x1 - x0) / f32(pieces);
    var sum = vec3f(0.0);
    var i = 0u;
    loop {
        // Gauss-Legendre with 4 nodes, as two pairs.
        let outer = (i & 1u) == 1u;
        let off = select(0.3399810435848563, 0.8611363115940526, outer) * half;
        let weight = select(0.6521451548625461, 0.3478548451374538, outer);
        let x = x0 + f32(2u * (i >> 1u) + 1u) * half;
        sum += weight * (lamp_node(light, index, m, origin, direction, t_near, h, x - off)
            + lamp_node(light, index, m, origin, direction, t_near, h, x + off));
        i++;
        if (i >= 2u * pieces) { break; }
    }
    return sum * half / h;
}

// Parallel light where the air is not one box: panels of Gauss-Legendre nodes in t.
fn parallel_nodes(
    light: LightData, index: u32, m: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    let half = 0.5 * (t1 - t0) / f32(lamp_pieces(m, 0.0, t1 - t0));
    let mu = -dot(light.direction, direction);
    var sum = vec3f(0.0);
    for (var t = t0 + half; t < t1; t += 2.0 * half) {
        for (var k = 0u; k < 4u; k++) {
            let off = select(0.3399810435848563, 0.8611363115940526, k > 1u) * half;
            let weight = select(0.6521451548625461, 0.3478548451374538, k > 1u);
            let at = t + select(off, -off, (k & 1u) == 0u);
            sum += weight * sent_by(light, index, m, origin + at * direction, at, mu, 0.0);
        }
    }
    return sum * half;
}

// The lit stretch t0..t1: radiance, W m^-2 sr^-1.
fn lit_run(
    light: LightData, index: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    if (AIR_IS_BOX && !HAS_LOCAL) {
        let a = max(t0, air_spans[0].x);
        let b = min(t1, air_spans[0].y);
        return select(vec3f(0.0), parallel_run(a, b) * light.color, a < b && run_has_shafts);
    }
    var sum = vec3f(0.0);
    var m = 0u;
    loop {
        let a = max(t0, air_spans[m].x);
        let b = min(t1, air_spans[m].y);
        if (a < b && air[m].has_shafts != 0u) {
            if (HAS_LOCAL && light.kind != LIGHT_DIRECTIONAL) {
                sum += lamp_run(light, index, m, origin, direction, a, b);
            } else if (HAS_DIRECTIONAL && AIR_IS_BOX) {
                sum += parallel_run(a, b);
            } else if (HAS_DIRECTIONAL) {
                sum += parallel_nodes(light, index, m, origin, direction, a, b);
            }
        }
        m++;
        if (m >= AIR_COUNT) { break; }
    }
    return sum * light.color;
}

// In one dense medium, no farther than light can come from.
fn visible_hull(hull: vec2f) -> vec2f {
    if (AIR_COUNT > 1u || AIR_GRIDS > 0u) {
        return hull;
    }
    let thinnest = min(air[0].sigma_t.x, min(air[0].sigma_t.y, air[0].sigma_t.z));
    return vec2f(hull.x, min(hull.y, hull.x + 16.0 / max(thinnest, 1e-12)));
}
