// The environment's light in each cell of a lattice, attenuated by media and shadowed by its maps.
//! use lattice_space
//! use map_visibility
//! use media_light
//! needs fn computed_cell(id: vec3u) -> vec3u
//! needs fn store(texel: vec3u, light: SkyLight)

// One of four offsets in the cell, of which each light takes the next one or two.
fn offset_in_cell(n: u32) -> vec3f {
    let k = n & 3u;
    return 0.5 + 0.25 * (vec3f(f32((0x3u >> k) & 1u), f32((0x5u >> k) & 1u), f32((0x9u >> k) & 1u))
        * 2.0 - 1.0);
}

fn visibility(world: vec3f, i: u32) -> f32 {
    let clip = row_of_views(i).clip_from_world * vec4f(world, 1.0);
    return map_visibility(depth, compare, i, map_coordinates(clip.xyz));
}

// The irradiance of light i of the sky in the cell, through media, W m^-2.
fn arriving(span: CellSpan, i: u32) -> vec3f {
    var light = row_of_lights(i);
    light.kind = LIGHT_DIRECTIONAL;
    var share = vec3f(0.0);
    for (var k = 0u; k < params.points; k++) {
        let p = point_in_span(lattice, span, offset_in_cell(params.points * i + k));
        share += visibility(p, i) * exp(-media_light_depth(light, i, p));
    }
    return share / f32(params.points) * light.color;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let id = computed_cell(invocation);
    if (any(id == NO_CELL)) {
        return;
    }
    // Bands of the light of the whole sky, and the irradiance of six sides.
    let span = cell_span(lattice, id);
    var light: SkyLight;
    for (var i = 0u; i < params.light_count; i++) {
        let e = arriving(span, i);
        let d = lattice_from_world(lattice, row_of_lights(i).direction);
        light.fluence += e;
        let tensor = vec4f(d.x * d.x - 1.0 / 3.0, d.y * d.y - 1.0 / 3.0, d.x * d.y, d.x * d.z);
        light.squares += mat3x4f(e.r * tensor, e.g * tensor, e.b * tensor);
        light.rest += d.y * d.z * e;
        for (var axis = 0u; axis < 3u; axis++) {
            light.flux[axis] += e * d[axis];
            light.plus[axis] += e * max(0.0, -d[axis]);
            light.minus[axis] += e * max(0.0, d[axis]);
        }
    }
    store(id + vec3u(0u, lattice.first_row, 0u), light);
}
