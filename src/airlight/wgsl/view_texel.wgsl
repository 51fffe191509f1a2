// Texels of square views. The including pass declares LightViewData.

// A texel's solid angle in perspective, or its area where the view is parallel; `centre` in -1..1.
fn view_texel_measure(view: LightViewData, centre: vec2f, resolution: u32) -> f32 {
    let area = view.texel.x * view.texel.y;
    if (view.is_perspective == 0u) {
        return area;
    }
    let tangent = centre * view.texel * f32(resolution) * 0.5;
    return area * pow(1.0 + dot(tangent, tangent), -1.5);
}

// The direction that its light travels in, or an eye looks in, towards a world point.
fn view_direction(view: LightViewData, world: vec3f, centre: vec2f) -> vec3f {
    let near = view.world_from_clip * vec4f(centre, 0.0, 1.0);
    return normalize(world - near.xyz / near.w);
}

// Distance squared from a perspective's eye, from the near plane's point on the same ray.
fn view_eye(view: LightViewData) -> vec3f {
    // All rays meet where w vanishes: the point that clip_from_world takes to (0, 0, z, 0).
    let p = view.world_from_clip * vec4f(0.0, 0.0, 1.0, 0.0);
    return p.xyz / p.w;
}
