// Irradiance of polygons and spheres in closed form, radiance 1, seen from the origin along +z; twins of maths/area_light.py.
//! use surface_reflection

const RIM_CORNERS = 12u;
const RIM_SCALE = 1.0233267;

// The angle between unit vectors times the z of the unit normal of their plane; the angle over its sine is a quotient
// of polynomials of the cosine, 1.5e-6 off at most (Heitz2016, in the code with it).
fn edge_integral(a: vec3f, b: vec3f) -> f32 {
    let cosine = dot(a, b);
    let x = abs(cosine);
    let v = 6.2831853 * (0.8543985 + (0.4965155 + 0.0145206 * x) * x) / (3.4175940 + (4.1616724 + x) * x);
    return cross(a, b).z * select(PI * inverseSqrt(max(1.0 - x * x, 1e-7)) - v, v, cosine > 0.0);
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
    // Where the edge crosses the horizon it is cut, and the cuts are joined at the end.
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

// The integrals along a line between two points of the cosine at the receiver, of normal `n`, over squares of distances:
// x times the sine at the line, as a thin cylinder sends (Heitz2017), y as points send evenly. Lines closer than
// `width` are as far as that.
fn segment_irradiance(a: vec3f, b: vec3f, n: vec3f, width: f32) -> vec2f {
    let a_up = dot(a, n);
    let b_up = dot(b, n);
    if (max(a_up, b_up) <= 0.0) {
        return vec2f(0.0);
    }
    // The part of the line above the horizon, from its point nearest to the receiver.
    let along = normalize(b - a);
    let cut = (a * b_up - b * a_up) / select(1.0, b_up - a_up, min(a_up, b_up) < 0.0);
    let low = dot(select(a, cut, a_up < 0.0), along);
    let high = dot(select(b, cut, b_up < 0.0), along);
    let nearest = a - dot(a, along) * along;
    let squared = max(dot(nearest, nearest), width * width);
    let h = sqrt(squared);
    // Cosines and sines of the angles from the nearest point, at both ends.
    let from_low = vec2f(h, low) * inverseSqrt(squared + low * low);
    let from_high = vec2f(h, high) * inverseSqrt(squared + high * high);
    let angle = atan2(h * (high - low), squared + high * low);
    // Both integrals are sums of these (Heitz2017).
    let products = from_high * from_high.y - from_low * from_low.y;
    let cosines = vec2f(dot(nearest, n) / h, dot(along, n));
    let cylinder = 0.5 * dot(cosines, vec2f(angle + products.x, products.y));
    let points = dot(cosines, vec2f(from_high.y - from_low.y, from_low.x - from_high.x));
    return max(vec2f(cylinder, points) / h, vec2f(0.0));
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
