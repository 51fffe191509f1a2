// Which cell an invocation computes: all of a lattice, or those of a list (media/stale_cells.py), one for each of its
// first invocations. The including pass declares `lattice`, and `params` with is_listed.
//! use cell_order

const NO_CELL = vec3u(0xffffffffu);

fn computed_cell(id: vec3u) -> vec3u {
    let count = lattice.count;
    if (any(id >= count)) {
        return NO_CELL;
    }
    if (params.is_listed == 0u) {
        return id;
    }
    let n = cell_in(count, id);
    if (n >= stale_cells[0]) {
        return NO_CELL;
    }
    return cell_at_index(count, stale_cells[n + 1u]);
}
