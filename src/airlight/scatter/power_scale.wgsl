// How many times as bright the sum must be for all that came in to have been lost, per channel.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= 3u) {
        return;
    }
    var found = vec2f(0.0);
    for (var k = 0u; k < PARTS; k++) {
        found += parts[id.x * PARTS + k];
    }
    // What came in has to be lost in the end: scaled so that the sum loses as much.
    let lost = found.x - found.y;
    scales[id.x] = select(1.0, clamp(found.x / max(lost, 1e-30), 1.0 / MOST, MOST), found.x > 0.0);
}
