// The largest coefficient of a lattice, and the power of two that scales it to what a format stores.
var<workgroup> partial: array<f32, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) own: u32) {
    // Each invocation's own share of the lattice, then the largest of all, by halves.
    var most = 0.0;
    for (var index = own; index < params.values; index += WX) {
        let v = abs(lattice[index]);
        most = max(most, max(max(v.x, v.y), max(v.z, v.w)));
    }
    partial[own] = most;
    for (var stride = WX / 2u; stride > 0u; stride /= 2u) {
        workgroupBarrier();
        if (own < stride) {
            partial[own] = max(partial[own], partial[own + stride]);
        }
    }
    workgroupBarrier();
    if (own == 0u) {
        range[0] = select(1.0, exp2(floor(log2(params.largest / partial[0]))), partial[0] > 0.0);
    }
}
