// Mean (sigma_s, sigma_t) of 2 x 2 x 2 cells.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.coarse;
    let channel = id.z / n.z;
    if (id.x >= n.x || id.y >= n.y || channel >= 3u) {
        return;
    }
    let at = vec3u(id.xy, id.z % n.z);
    let f = params.fine;
    var total = vec3f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let p = 2u * at + vec3u(k & 1u, (k >> 1u) & 1u, k >> 2u);
        if (all(p < f)) {
            total += vec3f(medium[((channel * f.z + p.z) * f.y + p.y) * f.x + p.x], 1.0);
        }
    }
    coarse_medium[((channel * n.z + at.z) * n.y + at.y) * n.x + at.x] = total.xy / total.z;
}
