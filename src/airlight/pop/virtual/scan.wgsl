// Running sums of all tiles, written over them, by one workgroup, in a fixed order.

var<workgroup> sums: array<f32, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32) {
    // Every lane adds up a stretch of tiles.
    let each = (params.count + WX - 1u) / WX;
    let first = min(lane * each, params.count);
    let end = min(first + each, params.count);
    var own = 0.0;
    for (var i = first; i < end; i++) {
        own += tiles[i];
    }
    sums[lane] = own;
    workgroupBarrier();
    // Then it adds the stretches of the lanes before, and writes its tiles' running sums.
    var running = 0.0;
    for (var i = 0u; i < lane; i++) {
        running += sums[i];
    }
    for (var i = first; i < end; i++) {
        running += tiles[i];
        tiles[i] = running;
    }
}
