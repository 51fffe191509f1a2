// Irradiance of polygons and spheres in closed form, radiance 1, seen from the origin along +z; twins of maths/area_light.py.
//! use sampling
//! use surface_reflection

const RIM_CORNERS = 12u;
const RIM_SCALE = 1.0233267;

// The angle between unit vectors times the z of the unit normal of their plane.
fn edge_integral(a: vec3f, b: vec3f) -> f32 {
    let normal = cross(a, b);
    let sine = length(normal);
    return normal.z * atan2(sine, dot(a, b)) / max(sine, 1e-20);
}

// A convex polygon corner by corner: the sum over the edges of its part above z = 0.
struct Outline {
    sum: f32,
    last: vec3f,    // unit
    down: vec3f,    // where it goes below, and where it comes up again
    up: vec3f,
}

fn outline_from(corner: vec3f) -> Outline {
    return Outline(0.0, normalize(corner), vec3f(0.0), vec3f(0.0));
}

fn outline_to(outline: Outline, corner: vec3f) -> Outline {
    var o = outline;
    let a = o.last;
    let b = normalize(corner);
    let is_above = a.z > 0.0;
    let goes_on = b.z > 0.0;
    let across = a * b.z - b * a.z;
    let cut = across * (sign(b.z - a.z) / max(length(across), 1e-20));
    o.down = select(o.down, cut, is_above && !goes_on);
    o.up = select(o.up, cut, goes_on && !is_above);
    let seen = edge_integral(select(cut, a, is_above), select(cut, b, goes_on));
    o.sum += select(0.0, seen, is_above || goes_on);
    o.last = b;
    return o;
}

// Irradiance, W m^-2, of radiance 1.
fn outline_irradiance(o: Outline) -> f32 {
    return 0.5 * abs(o.sum + edge_integral(o.down, o.up));
}

// The same of a sphere about `centre`, also where the horizon cuts it (Snyder1996).
fn sphere_irradiance(centre: vec3f, radius: f32) -> f32 {
    let distance = max(length(centre), radius * 1.0001);
    let cosine = clamp(centre.z / distance, -1.0, 1.0);
    let sine2 = (radius / distance) * (radius / distance);
    if (cosine * cosine >= sine2) {
        return PI * sine2 * max(cosine, 0.0);
    }
    let x = sqrt(1.0 / sine2 - 1.0);
    let sine = sqrt(1.0 - cosine * cosine);
    let y = clamp(-x * cosine / sine, -1.0, 1.0);
    let root = sine * sqrt(1.0 - y * y);
    return (cosine * acos(y) - x * root) * sine2 + atan(root / x);
}

// The disk at a sphere's centre that fills the same cone: its normal, and its radius.
fn sphere_disk(centre: vec3f, radius: f32) -> vec4f {
    let distance = max(length(centre), radius * 1.001);
    return vec4f(-centre / distance,
        radius * distance / sqrt(distance * distance - radius * radius));
}

// Corner k of the polygon that stands for a disk.
fn rim_corner(centre: vec3f, axes: mat3x3f, radius: f32, k: u32) -> vec3f {
    let angle = 6.2831853 * f32(k) / f32(RIM_CORNERS);
    return centre + radius * RIM_SCALE * (cos(angle) * axes[0] + sin(angle) * axes[1]);
}
