// Where a ray met a surface. The including pass binds `positions`. A ray that left the scene has its direction
// there, so that a pass whose eye is the origin sees what lies behind.

// 0 where there is none.
fn surface_depth(pixel: vec2u) -> f32 {
    return textureLoad(positions, pixel, 0).w;
}

fn surface_point(position: vec2f, d: f32) -> vec3f {
    return textureLoad(positions, vec2u(position), 0).xyz;
}

fn looking_point(p: vec3f) -> vec3f {
    return p;
}
