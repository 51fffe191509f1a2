// The density of a cell: the mean of its eight fine cells.
//! use medium_grid

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // The mean of its eight fine cells, so that no matter is lost.
    let first = 2u * cell_of(id.x);
    var sum = 0.0;
    for (var s = 0u; s < 8u; s++) {
        sum += textureLoad(fine, first + vec3u(s & 1u, (s >> 1u) & 1u, s >> 2u), 0).x;
    }
    density[id.x] = sum / 8.0;
}
