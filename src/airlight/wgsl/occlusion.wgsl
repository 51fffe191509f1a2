// Ambient occlusion of a slice, and what it means for light; sources in maths/occlusion.py.

// How open a slice is to its two sides, to horizons of these cosines (the second one's angle is negative):
// visible_arc of them without its cosine. `facing`: cosine and sine of the normal's angle.
fn visible_arcs(horizons: vec2f, facing: vec2f) -> vec2f {
    let c = clamp(horizons, vec2f(-1.0), vec2f(1.0));
    let sines = 1.0 - c * c;
    let turned = facing.y * (acos(c) - c * sqrt(sines));
    return 0.5 * (facing.x * sines + vec2f(turned.x, -turned.y));
}

fn interreflected(visibility: f32, albedo: vec3f) -> vec3f {
    let a = 2.0404 * albedo - 0.3324;
    let b = -4.7951 * albedo + 0.6417;
    let c = 2.7552 * albedo + 0.6903;
    return max(vec3f(visibility), ((visibility * a + b) * visibility + c) * visibility);
}

fn specular_visibility(visibility: f32, n_v: f32, roughness: f32) -> f32 {
    return saturate(pow(n_v + visibility, exp2(-16.0 * roughness - 1.0)) - 1.0 + visibility);
}

// Of a two-band state (a, b), what comes from the hidden directions, in units of pi / s^2.
fn hidden_flux(state: vec4f, direction: vec3f, visibility: f32) -> f32 {
    return max(state.x * (1.0 - visibility) - dot(state.yzw, direction), 0.0);
}

// The lattice's irradiance e with the near occluders' own light instead of what it has from them.
fn replaced(e: vec3f, from_them: vec3f, own: vec3f) -> vec3f {
    return max(e - from_them, vec3f(0.0)) + 3.14159265 * own;
}

// A depth (m) whose last bits are how much of a hemisphere is hidden: it may be read as it is, 1/2000 off.
const HIDDEN_BITS = 12u;
const HIDDEN_MASK = (1u << HIDDEN_BITS) - 1u;

fn packed_depth(depth: f32, hidden: f32) -> f32 {
    let share = u32(round(saturate(hidden) * f32(HIDDEN_MASK)));
    return bitcast<f32>((bitcast<u32>(depth) & ~HIDDEN_MASK) | share);
}

fn packed_hidden(depth: f32) -> f32 {
    return f32(bitcast<u32>(depth) & HIDDEN_MASK) / f32(HIDDEN_MASK);
}
