//! use lattice_space
//! use air_light

const LARGEST_HALF = 65504.0;

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
        let p = unbent_point(lattice, cell, place_in_cell(i, k));
        let open = lit(p, i);
        if (open > 0.0) {
            share += open * air_light_transmittance(light, i, p);
        }
    }
    return 0.5 * share * light.color;
}

fn stored(even: f32, flux: vec3f) -> vec4f {
    let v = params.scale * vec4f(even, flux);
    return clamp(v, vec4f(-LARGEST_HALF), vec4f(LARGEST_HALF));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    var fluence = vec3f(0.0);
    var flux = mat3x3f();
    var even = mat3x4f();       // of the third band, wgsl/third_band.wgsl
    var rest = vec3f(0.0);
    var plus = mat3x3f();
    var minus = mat3x3f();
    for (var i = 0u; i < params.light_count; i++) {
        let e = arriving(id, i);
        let way = lights[i].direction;
        fluence += e;
        let tensor = vec4f(way.x * way.x - 1.0 / 3.0, way.y * way.y - 1.0 / 3.0, way.x * way.y,
            way.x * way.z);
        even += mat3x4f(e.r * tensor, e.g * tensor, e.b * tensor);
        rest += way.y * way.z * e;
        for (var axis = 0u; axis < 3u; axis++) {
            flux[axis] += e * way[axis];
            plus[axis] += e * max(0.0, -way[axis]);
            minus[axis] += e * max(0.0, way[axis]);
        }
    }
    let texel = id + vec3u(0u, lattice.first_row, 0u);
    textureStore(red, texel, stored(fluence.r, vec3f(flux[0].r, flux[1].r, flux[2].r)));
    textureStore(green, texel, stored(fluence.g, vec3f(flux[0].g, flux[1].g, flux[2].g)));
    textureStore(blue, texel, stored(fluence.b, vec3f(flux[0].b, flux[1].b, flux[2].b)));
    textureStore(mean, texel, vec4f(stored(fluence.r, vec3f(0.0)).x,
        stored(fluence.g, vec3f(0.0)).x, stored(fluence.b, vec3f(0.0)).x, 1.0));
    let slab = vec3u(0u, 0u, textureDimensions(red).z);
    textureStore(third, texel, stored(even[0].x, even[0].yzw));
    textureStore(third, texel + slab, stored(even[1].x, even[1].yzw));
    textureStore(third, texel + 2u * slab, stored(even[2].x, even[2].yzw));
    textureStore(third, texel + 3u * slab, stored(rest.x, vec3f(rest.yz, 0.0)));
    // The ambient cube of lattice/skylight: +x -x +y -y +z -z.
    for (var axis = 0u; axis < 3u; axis++) {
        textureStore(cube, texel + 2u * axis * slab, vec4f(plus[axis], 1.0));
        textureStore(cube, texel + (2u * axis + 1u) * slab, vec4f(minus[axis], 1.0));
    }
}
