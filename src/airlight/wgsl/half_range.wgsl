// What half floats hold. Drivers differ in what becomes of light above: some store infinity.

const LARGEST_HALF = 65504.0;

fn in_half_range(light: vec3f) -> vec3f {
    return min(light, vec3f(LARGEST_HALF));
}

// Of either sign.
fn within_half_range(value: vec4f) -> vec4f {
    return clamp(value, vec4f(-LARGEST_HALF), vec4f(LARGEST_HALF));
}
