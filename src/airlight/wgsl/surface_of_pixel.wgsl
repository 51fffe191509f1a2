// Where the surface of a pixel lies, from the image's depth. The including pass binds `depth`, and what
// pixel_point needs.
//! use pixel_point

// 0 where there is none.
fn surface_depth(pixel: vec2u) -> f32 {
    return textureLoad(depth, pixel, 0);
}

fn surface_point(position: vec2f, d: f32) -> vec3f {
    return pixel_point(position, d);
}
