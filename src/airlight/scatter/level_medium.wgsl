// Mean (sigma_s, sigma_t) of 2 x 2 x 2 cells.
//! use level_cells
//! use channel_cells

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let cell = channel_cell(params.coarse, id);
    if (!cell.is_there) {
        return;
    }
    // Of those that there are: at the far border a coarse cell may be half empty.
    let f = params.fine;
    var total = vec3f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let p = fine_cell(cell.at, k);
        if (all(p < f)) {
            total += vec3f(medium[index_in(f, p, cell.channel)], 1.0);
        }
    }
    coarse_medium[index_in(params.coarse, cell.at, cell.channel)] = total.xy / total.z;
}
