// Visibility of an ordinate's light from a cell: the mean of four samples.
//! use medium_grid
//! use lights
//! use map_visibility
//! use shadow

// Offsets of the samples from the cell's centre, in cells: corners of a tetrahedron.
const OFFSETS = array<vec3f, 4>(
    vec3f(0.25, 0.25, 0.25), vec3f(-0.25, -0.25, 0.25), vec3f(-0.25, 0.25, -0.25),
    vec3f(0.25, -0.25, -0.25),
);

fn light_visibility(light: LightData, p: vec3f) -> f32 {
    let in = incoming(light, p);
    let view = view_of(light, in.to_light);
    if (light.kind == LIGHT_DIRECTIONAL) {
        return lit_share(parallel_shadows, shadow_compare, row_of_parallel_views(view), view, p,
            in.to_light, in.to_light, 1.0);
    }
    return lit_share(local_shadows, shadow_compare, row_of_local_views(view), view, p, in.to_light,
        in.to_light, in.distance);
}

fn sky_visibility(layer: u32, p: vec3f) -> f32 {
    let clip = row_of_sky_views(layer).clip_from_world * vec4f(p, 1.0);
    return map_visibility(sky_depth, shadow_compare, layer, map_coordinates(clip.xyz));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= params.ordinate_count || reach[id.x] == 0u) {
        return;
    }
    let s = shadows[id.y];
    if (s.light == 0u && s.count == 0u) {
        return;
    }
    var share = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let local = (vec3f(cell_of(id.x)) + 0.5 + OFFSETS[k]) * params.cell;
        let p = (params.world_from_medium * vec4f(local, 1.0)).xyz;
        // A light of the scene has a map, or a cube of them.
        if (s.light != 0u) {
            share += light_visibility(row_of_lights(s.light - 1u), p);
            continue;
        }
        // An ordinate of the sky is made of several of its lights.
        for (var i = 0u; i < s.count; i++) {
            let part = sky_shares[s.first + i];
            share += part.weight * sky_visibility(part.layer, p);
        }
    }
    passed[(params.ordinate_count + id.y) * params.cells + id.x] = 0.25 * share;
}
