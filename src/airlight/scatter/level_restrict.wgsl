// What a coarse cell has still to send on: the residual of its 2 x 2 x 2 fine cells, summed.
//! use level_cells

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.coarse;
    let channel = id.z / n.z;
    if (id.x >= n.x || id.y >= n.y || channel >= 3u) {
        return;
    }
    let at = vec3u(id.xy, id.z % n.z);
    // States are power, so eight cells together hold the sum.
    let f = params.fine;
    var total = vec4f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let p = fine_cell(at, k);
        if (all(p < f)) {
            let index = index_in(f, p, channel);
            total += stepped[index] - sum[index];
        }
    }
    residual[index_in(n, at, channel)] = total;
}
