// Sequences, hashes and warps; sources in maths/sampling.py.

const SAMPLING_QUARTER_PI = 0.7853981633974483;

fn pcg_hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// [0, 1) with 24 bits, exact.
fn uniform_from_hash(hashed: u32) -> f32 {
    return f32(hashed >> 8u) * 5.9604644775390625e-8;
}

// Blue-noise-like dither in [0, 1) of whole pixels and frames.
fn r2_noise(x_px: u32, y_px: u32, frame: u32) -> f32 {
    return uniform_from_hash(x_px * 3242174889u + y_px * 2447445413u + frame * 2654435769u);
}

fn interleaved_gradient_noise(x_px: f32, y_px: f32) -> f32 {
    return fract(52.9829189 * fract(0.06711056 * x_px + 0.00583715 * y_px));
}

// Point `index` of the R2 sequence, in u32 so that no index is too large.
fn r2_sequence(index: u32) -> vec2f {
    let fixed = vec2u(0x80000000u) + index * vec2u(3242174889u, 2447445413u);
    return vec2f(uniform_from_hash(fixed.x), uniform_from_hash(fixed.y));
}

// (t, density): distance in [t0, t1] sampled like 1/(h^2 + t^2); metres, m^-1.
fn equiangular_distance(u: f32, h_m: f32, t0_m: f32, t1_m: f32) -> vec2f {
    let x0 = atan2(t0_m, h_m);
    let x1 = atan2(t1_m, h_m);
    let t = h_m * tan(mix(x0, x1, u));
    return vec2f(t, h_m / ((x1 - x0) * (h_m * h_m + t * t)));
}

fn concentric_disk(u: vec2f) -> vec2f {
    let p = 2.0 * u - 1.0;
    let first = abs(p.x) > abs(p.y);
    let r = select(p.y, p.x, first);
    let safe = select(r, 1.0, r == 0.0);
    let phi = select(
        SAMPLING_QUARTER_PI * (2.0 - p.x / safe),
        SAMPLING_QUARTER_PI * (p.y / safe),
        first,
    );
    return r * vec2f(cos(phi), sin(phi));
}

fn cosine_hemisphere(u: vec2f) -> vec3f {
    let disk = concentric_disk(u);
    return vec3f(disk, sqrt(max(1.0 - dot(disk, disk), 0.0)));
}

// Columns: tangent, bitangent, normal.
fn orthonormal_frame(n: vec3f) -> mat3x3f {
    let sign = select(1.0, -1.0, n.z < 0.0);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let tangent = vec3f(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    return mat3x3f(tangent, vec3f(b, sign + n.y * n.y * a, -n.y), n);
}
