// Partial sums of what lattices and traced light say of each other: an invocation adds up every PARTS-th path.

override PARTS: u32 = 1;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= PARTS) {
        return;
    }
    var sum = vec4f(0.0);
    for (var path = id.x; path < params.paths; path += PARTS) {
        sum += shares[path];
    }
    parts[id.x] = sum;
}
