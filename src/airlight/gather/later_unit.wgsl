// The unit of the cells' sums: a small part of what paths bring in the mean, once some do.

const PART = 2.3283064e-10;     // 2^-32
const LOOKED_AT = 64u;          // paths, by each of the threads

var<workgroup> means: array<vec2f, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_id) id: vec3u) {
    // Each thread looks at every so many paths.
    var sum = vec2f(0.0);
    let step = max(params.paths / (WX * LOOKED_AT), 1u);
    for (var path = id.x * step; path < params.paths; path += WX * step) {
        let light = paths[2u * path].rgb;
        sum += vec2f(max(light.r, max(light.g, light.b)), 1.0);
    }
    means[id.x] = sum;
    workgroupBarrier();
    if (id.x == 0u) {
        var all = vec2f(0.0);
        for (var i = 0u; i < WX; i++) {
            all += means[i];
        }
        let mean = all.x / max(all.y, 1.0);
        if (unit[0] <= 0.0 && mean > 0.0) {
            // A power of two, so that scaling rounds nothing.
            unit[0] = PART * exp2(ceil(log2(mean)));
        }
    }
}
