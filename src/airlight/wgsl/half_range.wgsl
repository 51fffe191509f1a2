// Drivers differ in what becomes of light above the largest half float: some store infinity.

const LARGEST_HALF_LIGHT = 65504.0;

fn in_half_range(light: vec3f) -> vec3f {
    return min(light, vec3f(LARGEST_HALF_LIGHT));
}
