//! use lattice_space

// Places inside a cell where visibility is asked, in cells from its centre.
const PLACES = array<vec3f, 4>(
    vec3f(0.25, 0.25, 0.25), vec3f(-0.25, -0.25, 0.25), vec3f(-0.25, 0.25, -0.25),
    vec3f(0.25, -0.25, -0.25),
);

fn lit(world: vec3f, view: LightViewData, layer: u32) -> f32 {
    let clip = view.clip_from_world * vec4f(world, 1.0);
    let uv = clip.xy * vec2f(0.5, -0.5) + 0.5;
    if (any(uv < vec2f(0.0)) || any(uv > vec2f(1.0))) {
        return 1.0;
    }
    return textureSampleCompareLevel(depth, compare, uv, layer, clip.z);
}

// The cell's place in the lattice before it moved. Border cells see no wall on the far side.
fn place_before(id: vec3u) -> vec3i {
    return vec3i(id) + vec3i(params.shift_x, params.shift_y, params.shift_z);
}

fn is_inner(cell: vec3i) -> bool {
    return all(cell > vec3i(0)) && all(cell < vec3i(lattice.count) - 1);
}

fn kept(id: vec3u) {
    let depth = textureDimensions(cube).z / 6u;
    for (var face = 0u; face < 6u; face++) {
        let layer = vec3u(0u, 0u, face * depth);
        let value = textureLoad(before, place_before(id) + vec3i(layer), 0);
        textureStore(cube, id + layer + vec3u(0u, lattice.first_row, 0u), value);
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    if (params.has_before != 0u && is_inner(vec3i(id)) && is_inner(place_before(id))) {
        kept(id);
        return;
    }
    var faces = array<vec3f, 6>();
    for (var i = 0u; i < params.lights; i++) {
        let view = views[i];
        var share = 0.0;
        for (var k = 0u; k < 4u; k++) {
            share += lit(unbent_point(lattice, id, 0.5 + PLACES[k]), view, i);
        }
        let e = sky[i].irradiance.rgb * share * 0.25;
        let towards = -sky[i].direction.xyz;
        faces[0] += e * max(0.0, towards.x);
        faces[1] += e * max(0.0, -towards.x);
        faces[2] += e * max(0.0, towards.y);
        faces[3] += e * max(0.0, -towards.y);
        faces[4] += e * max(0.0, towards.z);
        faces[5] += e * max(0.0, -towards.z);
    }
    for (var face = 0u; face < 6u; face++) {
        let texel = id + vec3u(0u, lattice.first_row, face * textureDimensions(cube).z / 6u);
        textureStore(cube, texel, vec4f(faces[face], 1.0));
    }
}
