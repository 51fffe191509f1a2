// A half space without forward light; see half_space_forward.wgsl.

fn half_space_forward(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }
