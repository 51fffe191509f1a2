//! use lattice_space
//! use lobes

// A texel's solid angle in perspective, or its area where the light is parallel.
fn texel_measure(view: LightViewData, centre: vec2f) -> f32 {
    let area = view.texel.x * view.texel.y;
    if (view.is_perspective == 0u) {
        return area;
    }
    let tangent = centre * view.texel * f32(params.resolution) * 0.5;
    return area * pow(1.0 + dot(tangent, tangent), -1.5);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.resolution || id.y >= params.resolution || id.z >= params.layers) {
        return;
    }
    let texel = vec2i(id.xy);
    let power_density = textureLoad(flux, texel, id.z, 0).rgb;
    let d = textureLoad(depth, texel, id.z, 0);
    if (d >= 1.0 || all(power_density <= vec3f(0.0))) {
        return;
    }
    let view = views[id.z];
    let centre = (vec2f(id.xy) + 0.5) / f32(params.resolution) * vec2f(2.0, -2.0)
        + vec2f(-1.0, 1.0);
    let world = view.world_from_clip * vec4f(centre, d, 1.0);
    let n = normalize(textureLoad(normal, texel, id.z, 0).xyz);
    let place = bent_place(lattice, world.xyz / world.w) + 0.5 * n;
    add_lobe(place, n, power_density * texel_measure(view, centre));
}
