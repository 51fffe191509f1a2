// Where the surface of a pixel lies, from the image's depth. The including pass binds `depth`, what pixel_point needs,
// and in `params` the `eye`.
//! use pixel_point
//! use ray_start

// 0 where there is none.
fn surface_depth(pixel: vec2u) -> f32 {
    return textureLoad(depth, pixel, 0);
}

fn surface_point(position: vec2f, d: f32) -> vec3f {
    return pixel_point(position, d);
}

// The point from which lights are looked for.
fn looking_point(p: vec3f) -> vec3f {
    return shown_point(p, params.eye, pixel_width(params.world_from_clip, params.size.y));
}
