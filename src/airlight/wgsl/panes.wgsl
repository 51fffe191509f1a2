// The transmittance of translucent surfaces towards a light, rgb; see surface/panes.py. The including pass binds the lights'
// views and their maps parallel_panes and local_panes, and declares LightViewData.
//! use lights
//! use shadow

const PANE_SLACK = 0.002;   // of a half float's steps, two

fn pane_texel(maps: texture_2d_array<f32>, layer: u32, at: vec2i, depth: f32) -> vec3f {
    let most = vec2i(textureDimensions(maps)) - 1;
    let pane = textureLoad(maps, clamp(at, vec2i(0), most), layer, 0);
    return select(vec3f(1.0), pane.rgb, depth > pane.a * (1.0 + PANE_SLACK));
}

// Bilinear, of texels that each know whether the point lies behind their pane.
fn pane_share(maps: texture_2d_array<f32>, view: LightViewData, layer: u32, s: ShadowPoint) -> vec3f {
    if (!s.is_inside) {
        return vec3f(1.0);
    }
    let depth = select(s.depth, s.distance, view.is_perspective != 0u);
    let p = s.uv * vec2f(textureDimensions(maps)) - 0.5;
    let first = vec2i(floor(p));
    let share = p - floor(p);
    let low = mix(pane_texel(maps, layer, first, depth), pane_texel(maps, layer, first + vec2i(1, 0), depth), share.x);
    let high = mix(pane_texel(maps, layer, first + vec2i(0, 1), depth), pane_texel(maps, layer, first + 1, depth),
        share.x);
    return mix(low, high, share.y);
}

fn panes_passed(light: LightData, p: vec3f, n: vec3f, in: Incoming) -> vec3f {
    let index = view_of(light, in.to_light);
    if (light.kind == LIGHT_DIRECTIONAL) {
        let view = row_of_parallel_views(index);
        return pane_share(parallel_panes, view, index, shadow_point(view, p, n, in.to_light, 1.0));
    }
    let view = row_of_local_views(index);
    return pane_share(local_panes, view, index, shadow_point(view, p, n, in.to_light, in.distance));
}
