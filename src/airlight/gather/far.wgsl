// How long a ray must be for its light to come from afar: so many widths of a point at the geometric mean distance
// of all points from the eye. One length for a whole image, so that all points mean the same by it.
//! use gather

var<workgroup> parts: array<vec2f, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_id) id: vec3u) {
    // Each thread adds up the logarithms of its share of the points.
    let count = params.reduced.x * params.reduced.y;
    var sum = vec2f(0.0);
    for (var i = id.x; i < count; i += WX) {
        let distance = textureLoad(places, vec2u(i % params.reduced.x, i / params.reduced.x), 0).w;
        sum += select(vec2f(0.0), vec2f(log(distance), 1.0), distance > 0.0);
    }
    parts[id.x] = sum;
    workgroupBarrier();
    // The first adds up the threads'.
    if (id.x == 0u) {
        var all = vec2f(0.0);
        for (var i = 0u; i < WX; i++) {
            all += parts[i];
        }
        far[0] = FAR * params.texel * exp(all.x / max(all.y, 1.0));
    }
}
