//! use lattice_space
//! use media_light
//! needs fn store(texel: vec3u, light: SkyLight)

// Two of four places inside the cell, in turn; lights are many.
fn place_in_cell(i: u32, k: u32) -> vec3f {
    let n = 2u * (i & 1u) + k;
    return 0.5 + 0.25 * (vec3f(f32((0x3u >> n) & 1u), f32((0x5u >> n) & 1u), f32((0x9u >> n) & 1u))
        * 2.0 - 1.0);
}

fn lit(world: vec3f, i: u32) -> f32 {
    let clip = views[i].clip_from_world * vec4f(world, 1.0);
    let uv = clip.xy * vec2f(0.5, -0.5) + 0.5;
    if (any(uv < vec2f(0.0)) || any(uv > vec2f(1.0))) {
        return 1.0;
    }
    return textureSampleCompareLevel(depth, compare, uv, i, clip.z);
}

// W m^-2 of sky light i in the cell, through the air.
fn arriving(cell: vec3u, i: u32) -> vec3f {
    let light = lights[i];
    var share = vec3f(0.0);
    for (var k = 0u; k < 2u; k++) {
        let p = unwarped_point(lattice, cell, place_in_cell(i, k));
        let open = lit(p, i);
        if (open > 0.0) {
            share += open * media_light_transmittance(light, i, p);
        }
    }
    return 0.5 * share * light.color;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    var light: SkyLight;
    for (var i = 0u; i < params.light_count; i++) {
        let e = arriving(id, i);
        let way = lattice_from_world(lattice, lights[i].direction);
        light.fluence += e;
        let tensor = vec4f(way.x * way.x - 1.0 / 3.0, way.y * way.y - 1.0 / 3.0, way.x * way.y,
            way.x * way.z);
        light.even += mat3x4f(e.r * tensor, e.g * tensor, e.b * tensor);
        light.rest += way.y * way.z * e;
        for (var axis = 0u; axis < 3u; axis++) {
            light.flux[axis] += e * way[axis];
            light.plus[axis] += e * max(0.0, -way[axis]);
            light.minus[axis] += e * max(0.0, way[axis]);
        }
    }
    store(id + vec3u(0u, lattice.first_row, 0u), light);
}
