// A lattice less another one: rest = whole - part.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.values) {
        rest[id.x] = whole[id.x] - part[id.x];
    }
}
