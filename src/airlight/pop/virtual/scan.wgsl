// Running sums of all tiles, in place, by one workgroup; always added in the same order.

var<workgroup> sums: array<f32, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32) {
    let each = (params.count + WX - 1u) / WX;
    let first = min(lane * each, params.count);
    let end = min(first + each, params.count);
    var own = 0.0;
    for (var i = first; i < end; i++) {
        own += tiles[i];
    }
    sums[lane] = own;
    workgroupBarrier();
    var running = 0.0;
    for (var i = 0u; i < lane; i++) {
        running += sums[i];
    }
    for (var i = first; i < end; i++) {
        running += tiles[i];
        tiles[i] = running;
    }
}
