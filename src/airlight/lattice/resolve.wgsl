// Fixed-point sums on top of a lattice, which is left in W sr^-1; the sums are zero for the next frame.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.values) {
        return;
    }
    lattice[id.x] = base[id.x] + vec4f(sums[id.x]) * params.unit;
    sums[id.x] = vec4i(0);
}
