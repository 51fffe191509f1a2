// Radiance towards the eye from a lit interval of an eye ray that `media_enter` has entered, through homogeneous
// media. The including pass adds lit_interval_wgsl (media/shafts/shadow_rays.py), which says what cannot occur: CPU
// adapters run both sides of every branch, and bodies of loops once before a test at their head.
//! use media_ray
//! use media_light
//! use lights_in_media

// Where the straight path back to the light leaves the one medium's box: its length at the eye, and the slope of
// that along the ray, per axis; the least one counts.
var<private> box_exit: vec3f;
var<private> box_exit_slope: vec3f;
// Of the one medium, copied: CPU adapters read buffers lane by lane once anything has branched.
var<private> medium_sigma_t: vec3f;        // m^-1
var<private> parallel_sent: vec3f;           // of a directional light to the eye, m^-1 sr^-1
var<private> medium_has_shafts: bool;
var<private> is_light_inside: bool;       // whether a local light is in the one medium itself

// Once per eye ray and light.
fn prepare_lit_intervals(light: LightData, origin: vec3f, direction: vec3f) {
    let phase = scattering_phase(-dot(light.direction, direction), row_of_media(0).g);
    medium_sigma_t = row_of_media(0).sigma_t;
    parallel_sent = row_of_media(0).albedo * medium_sigma_t * phase;
    medium_has_shafts = has_shafts(0u, false) > 0.0;
    is_light_inside = MEDIA_COUNT == 1u && medium_density(0u, light.position) > 0.0;
    // Where light enters the box is linear along the ray, face by face.
    let o = medium_coordinates(0u, origin);
    let d = (row_of_media(0).volume_from_world * vec4f(direction, 0.0)).xyz;
    let back = -(row_of_media(0).volume_from_world * vec4f(light.direction, 0.0)).xyz;
    let is_parallel = abs(back) < vec3f(1e-12);
    let inverse = 1.0 / select(back, vec3f(1.0), is_parallel);
    box_exit = select((select(vec3f(0.0), vec3f(1.0), back > vec3f(0.0)) - o) * inverse,
        vec3f(MEDIUM_FAR), is_parallel);
    box_exit_slope = select(-d * inverse, vec3f(0.0), is_parallel);
}

fn least(v: vec3f) -> f32 {
    return min(v.x, min(v.y, v.z));
}

// Length of the light's path through the box to the ray at t, m.
fn light_path(t: f32) -> f32 {
    return max(least(box_exit + t * box_exit_slope), 0.0);
}

// Where beyond t the light's path next changes the face that it enters by; at most `end`.
fn next_face(t: f32, end: f32) -> f32 {
    let crossing = (box_exit.yzx - box_exit) / (box_exit_slope - box_exit_slope.yzx);
    let beyond = select(vec3f(end), crossing, crossing > vec3f(t * 1.000001 + 1e-6));
    return min(end, least(beyond));
}

// A directional light in one box of a homogeneous medium, closed form: between changes of face the optical depth
// along light and eye ray is linear. Source: Billeter2012 eq. 1.
fn parallel_interval(t0: f32, t1: f32) -> vec3f {
    let sigma_t = medium_sigma_t;
    let entry = medium_intervals[0].x;
    var sum = vec3f(0.0);
    var t = t0;
    var piece = 0u;
    loop {
        let end = next_face(t, t1);
        // Optical depths at both ends, towards the eye and the light; the integral between is exact.
        let a = sigma_t * (t - entry + light_path(t));
        let b = sigma_t * (end - entry + light_path(end));
        sum += exp(-min(a, b)) * (end - t) * mean_transmittance_rgb(abs(b - a));
        t = end;
        piece++;
        if (piece >= 4u || t >= t1) { break; }
    }
    return sum * parallel_sent;
}

// Radiance that medium m scatters to the eye at a point of the ray, per unit of length and irradiance; of a local light
// that of a point.
fn sent_by(light: LightData, index: u32, m: u32, p: vec3f, t: f32, seen: SeenLight) -> vec3f {
    var depth: vec3f;
    if (MEDIA_COUNT == 1u && is_light_inside) {
        depth = row_of_media(0).sigma_t * (t - medium_intervals[0].x + seen.reach);
    } else {
        depth = homogeneous_depth(0.0, t) + media_light_depth(light, index, p);
    }
    let phase = scattering_phase(seen.mu, seen.sharpness * row_of_media(m).g);
    return seen.gain * row_of_media(m).sigma_t * row_of_media(m).albedo * phase * exp(-depth);
}

// A local light at one node, an angle of `on`.
fn local_node(
    light: LightData, index: u32, m: u32, origin: vec3f, direction: vec3f, on: SeenInterval, x: f32,
) -> vec3f {
    let t = on.t_near + on.h * tan(x);
    let p = origin + t * direction;
    let away = p - light.position;
    let reach = on.h / cos(x);
    let seen = seen_light(light, away, -direction, reach, -sin(x));
    return sent_by(light, index, m, p, t, seen);
}

// Number of half panels of a local light's interval: narrow in angle where the phase function is sharp, and thin
// in depth.
fn local_pieces(m: u32, angle: f32, length_m: f32) -> u32 {
    let g = max(abs(row_of_media(m).g.x), max(abs(row_of_media(m).g.y), abs(row_of_media(m).g.z)));
    let sigma = max(row_of_media(m).sigma_t.x, max(row_of_media(m).sigma_t.y, row_of_media(m).sigma_t.z));
    let widest = mix(0.9, 0.2, saturate(g));
    return u32(clamp(ceil(max(angle / widest, sigma * length_m / 3.0)), 1.0, 12.0));
}

fn local_interval(
    light: LightData, index: u32, m: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    let on = seen_interval(light, origin, direction, t0, t1);
    let pieces = local_pieces(m, on.x1 - on.x0, t1 - t0);
    let half = 0.5 * (on.x1 - on.x0) / f32(pieces);
    var sum = vec3f(0.0);
    var i = 0u;
    loop {
        // Gauss-Legendre with 4 nodes, as two pairs.
        let outer = (i & 1u) == 1u;
        let off = select(0.3399810435848563, 0.8611363115940526, outer) * half;
        let weight = select(0.6521451548625461, 0.3478548451374538, outer);
        let x = on.x0 + f32(2u * (i >> 1u) + 1u) * half;
        sum += weight * (local_node(light, index, m, origin, direction, on, x - off)
            + local_node(light, index, m, origin, direction, on, x + off));
        i++;
        if (i >= 2u * pieces) { break; }
    }
    return sum * half / on.h;
}

// A directional light where the media are not one box: panels of Gauss-Legendre nodes in t.
fn parallel_nodes(
    light: LightData, index: u32, m: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    let half = 0.5 * (t1 - t0) / f32(local_pieces(m, 0.0, t1 - t0));
    let seen = SeenLight(1.0, 0.0, -dot(light.direction, direction), 1.0);
    var sum = vec3f(0.0);
    for (var t = t0 + half; t < t1; t += 2.0 * half) {
        for (var k = 0u; k < 4u; k++) {
            let off = select(0.3399810435848563, 0.8611363115940526, k > 1u) * half;
            let weight = select(0.6521451548625461, 0.3478548451374538, k > 1u);
            let at = t + select(off, -off, (k & 1u) == 0u);
            sum += weight * sent_by(light, index, m, origin + at * direction, at, seen);
        }
    }
    return sum * half;
}

// The lit interval t0..t1: radiance, W m^-2 sr^-1.
fn lit_interval(
    light: LightData, index: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    // One box of a homogeneous medium has a closed form for directional lights.
    if (IS_ONE_BOX && !HAS_LOCAL) {
        let a = max(t0, medium_intervals[0].x);
        let b = min(t1, medium_intervals[0].y);
        return select(vec3f(0.0), parallel_interval(a, b) * light.color, a < b && medium_has_shafts);
    }
    // Else medium by medium, in the part of the interval that lies in it.
    var sum = vec3f(0.0);
    var k = 0u;
    loop {
        if (HAS_MEDIA_TREE && k >= ray_media()) { break; }
        let m = ray_medium(k);
        let a = max(t0, medium_intervals[k].x);
        let b = min(t1, medium_intervals[k].y);
        if (a < b && has_shafts(m, light.kind != LIGHT_DIRECTIONAL) > 0.0) {
            if (HAS_LOCAL && light.kind != LIGHT_DIRECTIONAL) {
                sum += local_interval(light, index, m, origin, direction, a, b);
            } else if (HAS_DIRECTIONAL && IS_ONE_BOX) {
                sum += parallel_interval(a, b);
            } else if (HAS_DIRECTIONAL) {
                sum += parallel_nodes(light, index, m, origin, direction, a, b);
            }
        }
        k++;
        if (k >= ray_media()) { break; }
    }
    return sum * light.color;
}

// In one dense medium, no farther than light can come from (transmittance e^-16).
fn visible_interval(hull: vec2f) -> vec2f {
    if (MEDIA_COUNT > 1u || GRID_COUNT > 0u) {
        return hull;
    }
    let thinnest = min(row_of_media(0).sigma_t.x, min(row_of_media(0).sigma_t.y, row_of_media(0).sigma_t.z));
    return vec2f(hull.x, min(hull.y, hull.x + 16.0 / max(thinnest, 1e-12)));
}
