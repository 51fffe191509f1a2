// States of the cells of a lattice, channel after channel, x fastest. The including pass binds `params` (count),
// `before`, `added`, `after` and `faces`, and adds `State`, `unpacked` and `packed` (lpv.storage).
//! use cell_order
//! needs fn packed(v: vec4f) -> State
//! needs fn unpacked(v: State) -> vec4f

override IS_ADDED: bool = false;        // `added` to what is stored

fn cell_index(cell: vec3u) -> u32 {
    return cell_in(params.count, cell);
}

fn state_at(cell: u32) -> mat3x4f {
    let channel = params.count.x * params.count.y * params.count.z;
    return mat3x4f(unpacked(before[cell]), unpacked(before[cell + channel]), unpacked(before[cell + 2u * channel]));
}

// The state of the neighbour on one side of an axis; nothing beyond the lattice.
fn neighbour(cell: vec3u, axis: u32, is_high: bool) -> mat3x4f {
    let is_beyond = select(cell[axis] == 0u, cell[axis] + 1u >= params.count[axis], is_high);
    if (is_beyond) {
        return mat3x4f();
    }
    var beside = cell;
    beside[axis] = select(cell[axis] - 1u, cell[axis] + 1u, is_high);
    return state_at(cell_index(beside));
}

fn store_state(cell: u32, light: mat3x4f) {
    let channel = params.count.x * params.count.y * params.count.z;
    var state = light;
    if (IS_ADDED) {
        state += mat3x4f(unpacked(added[cell]), unpacked(added[cell + channel]),
            unpacked(added[cell + 2u * channel]));
    }
    after[cell] = packed(state[0]);
    after[cell + channel] = packed(state[1]);
    after[cell + 2u * channel] = packed(state[2]);
}
