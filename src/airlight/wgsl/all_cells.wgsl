// Which cell an invocation computes, in passes that compute all cells of `lattice`.

const NO_CELL = vec3u(0xffffffffu);

fn computed_cell(id: vec3u) -> vec3u {
    return select(id, NO_CELL, vec3<bool>(any(id >= lattice.count)));
}
