//! use medium_grid
//! use lights
//! use shadow

// Places in a cell where visibility is asked, in cells from its centre.
const PLACES = array<vec3f, 4>(
    vec3f(0.25, 0.25, 0.25), vec3f(-0.25, -0.25, 0.25), vec3f(-0.25, 0.25, -0.25),
    vec3f(0.25, -0.25, -0.25),
);

fn light_share(light: LightData, p: vec3f) -> f32 {
    let in = incoming(light, p);
    let view = view_of(light, in.to_light);
    if (light.kind == LIGHT_DIRECTIONAL) {
        return lit_share(parallel_shadows, shadow_compare, parallel_views[view], view, p,
            in.to_light, in.to_light, 1.0);
    }
    return lit_share(local_shadows, shadow_compare, local_views[view], view, p, in.to_light,
        in.to_light, in.distance);
}

fn sky_lit(layer: u32, p: vec3f) -> f32 {
    let clip = sky_views[layer].clip_from_world * vec4f(p, 1.0);
    let uv = clip.xy * vec2f(0.5, -0.5) + 0.5;
    if (any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) || clip.z >= 1.0) {
        return 1.0;
    }
    return textureSampleCompareLevel(sky_depth, shadow_compare, uv, layer, clip.z);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= params.ordinate_count || reach[id.x] == 0u) {
        return;
    }
    let s = sights[id.y];
    if (s.light == 0u && s.count == 0u) {
        return;
    }
    var share = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let local = (vec3f(cell_of(id.x)) + 0.5 + PLACES[k]) * params.cell;
        let p = (sight.world_from_medium * vec4f(local, 1.0)).xyz;
        if (s.light != 0u) {
            share += light_share(lights[s.light - 1u], p);
            continue;
        }
        for (var i = 0u; i < s.count; i++) {
            let seen = sky_shares[s.first + i];
            share += seen.weight * sky_lit(seen.layer, p);
        }
    }
    passed[(params.ordinate_count + id.y) * params.cells + id.x] = 0.25 * share;
}
