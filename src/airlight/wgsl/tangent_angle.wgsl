//! use sampling

// A vertex's tangent, from the number beside its normal; twin: maths/tangent_angle.py.

// `normal.w`: the angle about the normal, and by its sign the side of the bitangent; 0 for none, which gives 0.
fn tangent_of(normal: vec4f) -> vec4f {
    if (normal.w == 0.0) {
        return vec4f(0.0);
    }
    let frame = orthonormal_frame(normalize(normal.xyz));
    let angle = (abs(normal.w) * 32767.0 - 1.0) * (6.2831853 / 32766.0);
    return vec4f(frame * vec3f(cos(angle), sin(angle), 0.0), sign(normal.w));
}
