// What a coarse cell has still to send on: the residual of its 2 x 2 x 2 fine cells, summed.
//! use level_cells
//! use channel_cells

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let cell = channel_cell(params.coarse, id);
    if (!cell.is_there) {
        return;
    }
    // States are power, so eight cells together hold the sum.
    let f = params.fine;
    var total = vec4f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let p = fine_cell(cell.at, k);
        if (all(p < f)) {
            let index = index_in(f, p, cell.channel);
            total += stepped[index] - sum[index];
        }
    }
    residual[index_in(params.coarse, cell.at, cell.channel)] = total;
}
