// Marching where no medium is endless; see half_space.wgsl.

fn inside_lattices() -> f32 { return 1.0; }
fn lattice_interval(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f { return hull; }
fn step_length(t: f32, lattice: vec2f, near: f32) -> f32 { return near; }
