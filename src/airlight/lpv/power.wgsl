// The constant terms of a lattice's states, summed per channel: its power over 4 pi. Always in the same order.
//! needs fn unpacked(v: State) -> vec4f

var<workgroup> partial: array<vec3f, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) own: u32) {
    // Each invocation's own share of the lattice, then the sum of all, by halves.
    var sum = vec3f(0.0);
    for (var cell = own; cell < params.cells; cell += WX) {
        sum += vec3f(unpacked(state[cell]).x, unpacked(state[cell + params.cells]).x,
            unpacked(state[cell + 2u * params.cells]).x);
    }
    partial[own] = sum;
    for (var stride = WX / 2u; stride > 0u; stride /= 2u) {
        workgroupBarrier();
        if (own < stride) {
            partial[own] += partial[own + stride];
        }
    }
    workgroupBarrier();
    if (own == 0u) {
        powers[params.slot] = vec4f(partial[0], 0.0);
    }
}
