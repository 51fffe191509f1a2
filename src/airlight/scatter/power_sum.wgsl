// Partial sums of the power that came in, and of what is under way still. An invocation adds up
// every PARTS-th cell of a channel.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let channel = id.y;
    if (id.x >= PARTS || channel >= 3u) {
        return;
    }
    let cells = params.count.x * params.count.y * params.count.z;
    var found = vec2f(0.0);
    // Constant terms alone: they are the power.
    for (var cell = id.x; cell < cells; cell += PARTS) {
        let index = channel * cells + cell;
        found += vec2f(source[index].x, stepped[index].x - sum[index].x);
    }
    parts[channel * PARTS + id.x] = found;
}
