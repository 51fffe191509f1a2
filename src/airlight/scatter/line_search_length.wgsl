// How long the correction is, per channel: whole, but at most so many times as long as leaves the
// least residual.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= 3u) {
        return;
    }
    var found = vec2f(0.0);
    for (var k = 0u; k < PARTS; k++) {
        found += parts[id.x * PARTS + k];
    }
    // (r.d) / (d.d) leaves the least residual.
    lengths[id.x] = clamp(params.most * select(0.0, found.x / found.y, found.y > 0.0), 0.0, 1.0);
}
