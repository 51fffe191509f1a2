// Partial sums of r.d and d.d over coarse cells: r is what the sum so far lacks there, d what the
// correction takes off it. Within coarse cells the correction is rough, which smoothing mends.
// An invocation adds up every PARTS-th coarse cell of a channel.
//! use level_cells
//! use channel_cells
//! use cell_order

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let channel = id.y;
    if (id.x >= PARTS || channel >= 3u) {
        return;
    }
    let n = params.coarse;
    let f = params.fine;
    var found = vec2f(0.0);
    for (var cell = id.x; cell < n.x * n.y * n.z; cell += PARTS) {
        let at = cell_at_index(n, cell);
        // The residual and what the correction leaves of it, of all fine cells in the coarse one.
        var lacking = vec4f(0.0);
        var taken = vec4f(0.0);
        for (var k = 0u; k < 8u; k++) {
            let p = fine_cell(at, k);
            if (all(p < f)) {
                let index = index_in(f, p, channel);
                lacking += stepped[index] - sum[index];
                taken += change[index] - answer[index];
            }
        }
        found += vec2f(dot(lacking, taken), dot(taken, taken));
    }
    parts[channel * PARTS + id.x] = found;
}
