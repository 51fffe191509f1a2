// The mean densities of grids towards four lights, at all texels; those of planes are known.
//! use column_paths

// Of some texels along z, towards four lights.
var<private> means: array<vec4f, RUN>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    // Grids lie behind one another, in each the slabs of texels for four lights.
    let groups = (params.lights + 3u) / 4u;
    let place = id.z / (params.runs * groups);
    let group = id.z / params.runs % groups;
    if (place >= params.grids) {
        return;
    }
    let g = listed[params.first + place];
    let grid = grids[g];
    let apart = (grid.count.z + RUN - 1u) / RUN;
    let first = vec3u(id.xy, id.z % params.runs);
    if (any(first >= vec3u(grid.count.xy, apart))) {
        return;
    }
    // Texels of one light after the other, as far apart as leaves every invocation the same number.
    for (var k = 0u; k < 4u; k++) {
        let light = 4u * group + k;
        if (light >= params.lights) { break; }
        let path = paths[g * params.lights + light];
        for (var i = 0u; i < RUN; i++) {
            let z = first.z + i * apart;
            if (z >= grid.count.z) { break; }
            let texel = vec3f(vec3u(first.xy, z));
            means[i][k] = mean_towards(grid, path, texel, place * params.lights + light);
        }
    }
    // Four lights share a texel, and so are written together.
    for (var i = 0u; i < RUN; i++) {
        let z = first.z + i * apart;
        if (z >= grid.count.z) { break; }
        textureStore(columns, grid.first + vec3u(first.xy, z + group * grid.count.z), means[i]);
    }
}
