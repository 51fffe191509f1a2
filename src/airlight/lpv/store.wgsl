// A lattice in another format, scaled to its range.
//! needs fn packed(v: vec4f) -> State

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.values) {
        stored[id.x] = packed(lattice[id.x] * range[0]);
    }
}
