// The cells of a region get its share, without direction; those of none keep what they have.
//! use channel_cells

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let cell = channel_cell(params.count, id);
    if (!cell.is_there) {
        return;
    }
    let region = regions[index_in(params.count, cell.at, 0u)] & 255u;
    if (region < REGIONS) {
        stepped[index_in(params.count, cell.at, cell.channel)].x += shares[cell.channel * REGIONS + region];
    }
}
