// Marching without forward light; see forward_light.wgsl.

fn forward_light(
    p: vec3f, travel: vec3f, reached: vec3f, reduced_reached: vec3f,
) -> vec3f {
    return vec3f(0.0);
}
