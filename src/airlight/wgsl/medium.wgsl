// Attenuation along straight paths, ray intervals (t0, t1; a miss has t0 > t1); see maths/medium.py.

const MEDIUM_FAR = 3.0e38;

fn transmittance(sigma_t: vec3f, length_m: f32) -> vec3f {
    return exp(-sigma_t * length_m);
}

// phi1(x) = (1 - exp(-x))/x.
fn mean_transmittance(x: f32) -> f32 {
    let series = 1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0)));
    let small = abs(x) < 0.1;
    let safe = select(x, 1.0, small);
    return select((1.0 - exp(-safe)) / safe, series, small);
}

fn mean_transmittance_rgb(x: vec3f) -> vec3f {
    return vec3f(mean_transmittance(x.r), mean_transmittance(x.g), mean_transmittance(x.b));
}

// From all of a light that reaches `inner` optical depths ahead of its middle and behind it; `depth`: from its middle.
fn transmittance_from_within(depth: vec3f, inner: vec3f) -> vec3f {
    let within = min(depth, inner);
    return exp(within - depth) * mean_transmittance_rgb(2.0 * within);
}

fn ray_box_interval(origin: vec3f, direction: vec3f, low: vec3f, high: vec3f) -> vec2f {
    let is_parallel = direction == vec3f(0.0);
    let inside = (low <= origin) & (origin <= high);
    let inverse = 1.0 / select(direction, vec3f(1.0), is_parallel);
    let a = (low - origin) * inverse;
    let b = (high - origin) * inverse;
    let open = select(vec3f(MEDIUM_FAR), vec3f(-MEDIUM_FAR), inside);
    let near = select(min(a, b), open, is_parallel);
    let far = select(max(a, b), -open, is_parallel);
    return vec2f(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

fn ray_sphere_interval(origin: vec3f, direction: vec3f, centre: vec3f, radius_m: f32) -> vec2f {
    let to_centre = centre - origin;
    let middle = dot(to_centre, direction);
    let off_axis = to_centre - middle * direction;
    let left = radius_m * radius_m - dot(off_axis, off_axis);
    if (left < 0.0) {
        return vec2f(MEDIUM_FAR, -MEDIUM_FAR);
    }
    let half = sqrt(left);
    return vec2f(middle - half, middle + half);
}

// h and the parameter of the ray's origin, where t = 0 is closest to the light; metres.
fn ray_light_geometry(origin: vec3f, direction: vec3f, light: vec3f) -> vec2f {
    let to_eye = origin - light;
    let t_eye = dot(to_eye, direction);
    return vec2f(length(to_eye - t_eye * direction), t_eye);
}

fn ray_cone_interval(
    origin: vec3f,
    direction: vec3f,
    apex: vec3f,
    axis: vec3f,
    cos_half_angle: f32,
) -> vec2f {
    // The cone's equation (x.axis)^2 = cos^2 |x|^2 along the ray: qa t^2 + 2 qb t + qc = 0.
    let o = origin - apex;
    let c2 = cos_half_angle * cos_half_angle;
    let da = dot(direction, axis);
    let oa = dot(o, axis);
    let steep = da * da - c2;
    let qa = select(steep, 1e-7, abs(steep) < 1e-7);
    let qb = oa * da - c2 * dot(o, direction);
    let qc = oa * oa - c2 * dot(o, o);
    let discriminant = qb * qb - qa * qc;
    // Its roots without cancellation.
    let q = -(qb + select(1.0, -1.0, qb < 0.0) * sqrt(max(discriminant, 0.0)));
    let r0 = q / qa;
    let r1 = qc / select(q, 1e-30, q == 0.0);
    let low = min(r0, r1);
    let high = max(r0, r1);
    // Steeper than the cone, the ray stays inside beyond a root; flatter, it is inside between both, if in this nappe.
    if (qa > 0.0) {
        return select(vec2f(-MEDIUM_FAR, low), vec2f(high, MEDIUM_FAR), da > 0.0);
    }
    let chord = discriminant > 0.0 && oa + 0.5 * (low + high) * da >= 0.0;
    return select(vec2f(MEDIUM_FAR, -MEDIUM_FAR), vec2f(low, high), chord);
}
