// The mean colour of the walls in and around a cell, which reflect what its closed hops send.
// `faces` holds, per cell and outgoing hop, the reflected share (rgb) and the closed share (a). A
// hop across an edge or a corner may be stopped by a neighbour's face, so neighbours count too.
//! use cell_order

fn faces_of(cell: vec3i) -> vec4f {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(params.count))) {
        return vec4f(0.0);
    }
    let c = vec3u(cell);
    let index = 2u * cell_in(params.count, c);
    let side = faces[index];
    let rest = faces[index + 1u];
    return unpack4x8unorm(side.x) + unpack4x8unorm(side.y) + unpack4x8unorm(side.z)
        + unpack4x8unorm(side.w) + unpack4x8unorm(rest.x) + unpack4x8unorm(rest.y);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    // The cell's own walls count as much as all others around it.
    var sum = 25.0 * faces_of(vec3i(id));
    for (var k = 0u; k < 27u; k++) {
        sum += faces_of(vec3i(id) + vec3i(cell_at_index(vec3u(3u), k)) - 1);
    }
    let cell = cell_in(params.count, id);
    let rgb = sum.rgb / max(sum.a, 1e-6);
    reflectance[cell] = pack4x8unorm(vec4f(saturate(rgb), 0.0));
}
