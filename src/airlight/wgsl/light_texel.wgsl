// Texels of the map of a light, or of another view. The including pass declares the struct LightViewData.

// Clip coordinates of a texel's centre.
fn texel_centre(texel: vec2u, resolution: u32) -> vec2f {
    return (vec2f(texel) + 0.5) / f32(resolution) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
}

// The world point of depth d, metres.
fn texel_point(view: LightViewData, centre: vec2f, d: f32) -> vec3f {
    let world = view.world_from_clip * vec4f(centre, d, 1.0);
    return world.xyz / world.w;
}

// A texel's solid angle in perspective, or its area where the light is parallel.
fn texel_measure(view: LightViewData, centre: vec2f, resolution: u32) -> f32 {
    let area = view.texel.x * view.texel.y;
    if (view.is_perspective == 0u) {
        return area;
    }
    let tangent = centre * view.texel * f32(resolution) * 0.5;
    return area * pow(1.0 + dot(tangent, tangent), -1.5);
}
