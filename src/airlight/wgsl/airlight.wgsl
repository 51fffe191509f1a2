// Light scattered once towards the eye, per sigma_s and per unit of the light; see
// maths/airlight.py. Gauss-Legendre with 8 nodes, unrolled: indexing a constant array is slow.
//! use phase
//! use medium

// h and the parameter of the ray's origin, where t = 0 is closest to the light; metres.
fn ray_light_geometry(origin: vec3f, direction: vec3f, light: vec3f) -> vec2f {
    let to_eye = origin - light;
    let t_eye = dot(to_eye, direction);
    return vec2f(length(to_eye - t_eye * direction), t_eye);
}

fn spot_falloff(cosine: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    let x = clamp((cosine - cos_outer) / max(cos_inner - cos_outer, 1e-6), 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

fn airlight_node(x: f32, h: f32, t_eye: f32, sigma_t: vec3f, g: vec3f) -> vec3f {
    let s = sin(x);
    let c = cos(x);
    // tan X + 1/cos X as cos X/(1 - sin X) where sin X < 0: no cancellation towards -pi/2.
    let path = h * select((1.0 + s) / c, c / (1.0 - s), s < 0.0) - t_eye;
    return henyey_greenstein_rgb(-s, g) * exp(-sigma_t * path);
}

fn airlight_pair(x: f32, dx: f32, h: f32, t_eye: f32, sigma_t: vec3f, g: vec3f) -> vec3f {
    return airlight_node(x - dx, h, t_eye, sigma_t, g) + airlight_node(x + dx, h, t_eye, sigma_t, g);
}

fn point_airlight(
    h_m: f32,
    t0_m: f32,
    t1_m: f32,
    t_eye_m: f32,
    sigma_t: vec3f,
    g: vec3f,
) -> vec3f {
    let h = max(h_m, 1e-4 * max(abs(t0_m), abs(t1_m)) + 1e-12);
    let x0 = atan2(t0_m, h);
    let x1 = atan2(t1_m, h);
    let x = 0.5 * (x0 + x1);
    let w = max(0.5 * (x1 - x0), 0.0);
    let sum = 0.3626837833783620 * airlight_pair(x, 0.1834346424956498 * w, h, t_eye_m, sigma_t, g)
        + 0.3137066458778873 * airlight_pair(x, 0.5255324099163290 * w, h, t_eye_m, sigma_t, g)
        + 0.2223810344533745 * airlight_pair(x, 0.7966664774136267 * w, h, t_eye_m, sigma_t, g)
        + 0.1012285362903763 * airlight_pair(x, 0.9602898564975363 * w, h, t_eye_m, sigma_t, g);
    return sum * w / h;
}

fn spot_pair(
    x: f32,
    dx: f32,
    h: f32,
    t_eye: f32,
    sigma_t: vec3f,
    g: vec3f,
    axis: vec2f,
    cone: vec2f,
) -> vec3f {
    let a = axis.x * cos(x - dx) + axis.y * sin(x - dx);
    let b = axis.x * cos(x + dx) + axis.y * sin(x + dx);
    return spot_falloff(a, cone.x, cone.y) * airlight_node(x - dx, h, t_eye, sigma_t, g)
        + spot_falloff(b, cone.x, cone.y) * airlight_node(x + dx, h, t_eye, sigma_t, g);
}

// axis_off, axis_along and the cosines as in maths/airlight.py.
fn spot_airlight(
    h_m: f32,
    t0_m: f32,
    t1_m: f32,
    t_eye_m: f32,
    sigma_t: vec3f,
    axis_off: f32,
    axis_along: f32,
    cos_inner: f32,
    cos_outer: f32,
    g: vec3f,
) -> vec3f {
    let h = max(h_m, 1e-4 * max(abs(t0_m), abs(t1_m)) + 1e-12);
    let x0 = atan2(t0_m, h);
    let x1 = atan2(t1_m, h);
    let x = 0.5 * (x0 + x1);
    let w = max(0.5 * (x1 - x0), 0.0);
    let a = vec2f(axis_off, axis_along);
    let k = vec2f(cos_inner, cos_outer);
    let e = t_eye_m;
    let sum = 0.3626837833783620 * spot_pair(x, 0.1834346424956498 * w, h, e, sigma_t, g, a, k)
        + 0.3137066458778873 * spot_pair(x, 0.5255324099163290 * w, h, e, sigma_t, g, a, k)
        + 0.2223810344533745 * spot_pair(x, 0.7966664774136267 * w, h, e, sigma_t, g, a, k)
        + 0.1012285362903763 * spot_pair(x, 0.9602898564975363 * w, h, e, sigma_t, g, a, k);
    return sum * w / h;
}

// Parallel light: it travels s0 + q t through the medium to reach the ray at t.
fn directional_airlight(
    length_m: f32,
    light_path_m: f32,
    light_path_slope: f32,
    sigma_t: vec3f,
    mu: f32,
    g: vec3f,
) -> vec3f {
    let depth = sigma_t * ((1.0 + light_path_slope) * length_m);
    return henyey_greenstein_rgb(mu, g) * exp(-sigma_t * light_path_m) * length_m
        * mean_transmittance_rgb(depth);
}
