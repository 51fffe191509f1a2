@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.values) {
        total[id.x] = select(total[id.x], vec4f(0.0), params.is_first != 0u) + state[id.x];
    }
}
