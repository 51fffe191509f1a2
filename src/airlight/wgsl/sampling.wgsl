// Hashes, noise and frames; sources in maths/sampling.py.

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

// Columns: tangent, bitangent, normal.
fn orthonormal_frame(n: vec3f) -> mat3x3f {
    let sign = select(1.0, -1.0, n.z < 0.0);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    let tangent = vec3f(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    return mat3x3f(tangent, vec3f(b, sign + n.y * n.y * a, -n.y), n);
}
