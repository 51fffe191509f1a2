// One iteration of propagation to 26 neighbours, a cell and channel per invocation:
// after = source + K before, where K makes the next state of one, or the track that it leaves.
//! use step26
//! use channel_cells

// Beyond the lattice there is no light, and the medium goes on as at its border.
fn cell_at(at: vec3i, channel: u32) -> Cell {
    let inside = vec3u(clamp(at, vec3i(0), vec3i(params.count) - 1));
    let index = index_in(params.count, inside, channel);
    let state = select(vec4f(0.0), before[index], all(vec3i(inside) == at));
    if (IS_VARIED) {
        return varied_cell(state, medium[index]);
    }
    return homogeneous_cell(state * coefficients[params.row + channel].gain);
}

fn walls_at(cell: u32, channel: u32) -> Walls {
    if (!HAS_WALLS) {
        return no_walls();
    }
    let p = 4u * cell;
    return unpacked_walls(array<vec4u, 4>(packs[p], packs[p + 1u], packs[p + 2u], packs[p + 3u]),
        channel);
}

fn cell_beside(at: vec3i, channel: u32, step: vec3i) -> Cell {
    return cell_at(at + step, channel);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let cell = channel_cell(params.count, id);
    if (!cell.is_there) {
        return;
    }
    // The cell, what its medium does to light, and the walls around it.
    let at = vec3i(cell.at);
    let own = cell_at(at, cell.channel);
    var c = coefficients[params.row + cell.channel];
    if (IS_VARIED && HANDED_ON == 0.0) {
        c = varied_coefficients(own);
    }
    var walls = walls_at(index_in(params.count, cell.at, 0u), cell.channel);
    // Whatever its 26 neighbours send, and what it keeps of what it sends them.
    let index = index_in(params.count, cell.at, cell.channel);
    after[index] = source[index] + exchanged(Here(at, cell.channel, own, c), &walls);
}
