// Points on the rays of an image's pixels. The including pass binds `params` with the image's
// `world_from_clip` and its `size` in pixels.

// The world point of a position in the image (px); where nothing is (d = 0), one far off.
fn pixel_point(position: vec2f, d: f32) -> vec3f {
    let ndc = vec2f(position.x / params.size.x, 1.0 - position.y / params.size.y) * 2.0 - 1.0;
    // Reversed depth: any depth > 0 is in front of the eye, and a square of this point is no infinity.
    let point = params.world_from_clip * vec4f(ndc, max(d, 1e-20), 1.0);
    return point.xyz / point.w;
}
