// The power that a step has brought to each region: what is under way there. A workgroup for each region and channel.

var<workgroup> parts: array<f32, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32,
        @builtin(workgroup_id) group: vec3u) {
    let offset = group.y * params.count.x * params.count.y * params.count.z;
    var own = 0.0;
    for (var k = starts[group.x] + lane; k < starts[group.x + 1u]; k += WX) {
        let index = offset + members[k];
        own += stepped[index].x - sum[index].x;
    }
    parts[lane] = own;
    workgroupBarrier();
    // Always in the same order.
    if (lane == 0u) {
        var total = 0.0;
        for (var i = 0u; i < WX; i++) {
            total += parts[i];
        }
        missing[group.y * REGIONS + group.x] = total;
    }
}
