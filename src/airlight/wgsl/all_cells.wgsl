// Which cell an invocation computes, in passes over all cells of `lattice`: its own. Passes ask `computed_cell`, so that
// the same shader may compute the cells of a list alone, with `listed_cells.wgsl` in place of this file.

const NO_CELL = vec3u(0xffffffffu);

fn computed_cell(id: vec3u) -> vec3u {
    return select(id, NO_CELL, vec3<bool>(any(id >= lattice.count)));
}
