// One step of light that spreads from the regions' middles, a cell at a time through open faces: each cell knows how far the
// nearest middle is and whose it is. maths.regions.flooded is the NumPy twin.
//! use cell_order
//! use entering_share

const UNREACHED = 0xffffffffu;
const STEP = 65536u;        // and multiples of 256 for the sum of the coordinates of a region, to which its number is added

// The region in whose middle a cell lies: the cells' box is cut into params.regions equal boxes.
fn middle_of(cell: vec3u) -> u32 {
    let part = cell * params.regions / params.count;
    let middle = (2u * part + 1u) * params.count / (2u * params.regions);
    // Of regions as near the one nearer to the lattice's corner has a cell, so that all axes are alike.
    let ranked = 256u * (part.x + part.y + part.z) + cell_in(params.regions, part);
    return select(UNREACHED, ranked, all(middle == cell));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let index = cell_in(params.count, id);
    if (params.step == 0u) {
        after[index] = middle_of(id);
        return;
    }
    // Hops along x, back along x, along y and so on come from the six neighbours.
    var found = before[index];
    for (var hop = 0u; hop < 6u; hop++) {
        var beside = vec3i(id);
        beside[hop / 2u] += select(1, -1, (hop & 1u) == 0u);
        if (any(beside < vec3i(0)) || any(beside >= vec3i(params.count))) {
            continue;
        }
        let is_open = params.has_walls == 0u || entering_share(face_visibility[index], hop) > OPEN;
        let far = before[cell_in(params.count, vec3u(beside))];
        if (is_open && far != UNREACHED) {
            found = min(found, far + STEP);
        }
    }
    after[index] = found;
}
