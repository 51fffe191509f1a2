@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.values) {
        return;
    }
    lattice[id.x] = base[id.x] + vec4f(sums[id.x]) * params.unit;
    sums[id.x] = vec4i(0);
}
