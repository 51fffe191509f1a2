// The factor of the lattices' light, from all partial sums.
//! use gather

override PARTS: u32 = 1;

var<workgroup> rows: array<vec4f, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_id) id: vec3u) {
    // Each thread adds up its share of them.
    var sum = vec4f(0.0);
    for (var i = id.x; i < PARTS; i += WX) {
        sum += parts[i];
    }
    rows[id.x] = sum;
    workgroupBarrier();
    // The first adds up the threads'.
    if (id.x == 0u) {
        var all = vec4f(0.0);
        for (var i = 0u; i < WX; i++) {
            all += rows[i];
        }
        factor[0] = calibration(all.x, all.y, all.z);
    }
}
