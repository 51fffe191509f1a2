// One step of light that spreads from where regions begin, a cell at a time through open faces: each cell knows how far the
// nearest of these is and whose it is. maths.regions.flooded is the NumPy twin.
//! use open_both_ways

const UNREACHED = 0xffffffffu;
const STEP = 65536u;        // and multiples of 256 for the sum of the coordinates of a region's box, to which its number is added

// Of regions as near the one nearer to the lattice's corner has a cell, so that all axes are alike.
fn ranked(box: u32) -> u32 {
    let part = cell_at_index(params.regions, box);
    return 256u * (part.x + part.y + part.z) + box;
}

// What a cell is at first: `own`, or the beginning of a region.
fn begun(cell: vec3u, own: u32) -> u32 {
    let box = cell_in(params.regions, cell * params.regions / params.count);
    let seed = seeds[box];
    if (seed.y == 0u || seed.x != cell_in(params.count, cell)) {
        return own;
    }
    if (params.turn == 0u) {
        return ranked(box);
    }
    // In the second turn the boxes with the most cells have the numbers that are left.
    let boxes = params.regions.x * params.regions.y * params.regions.z;
    var number = boxes;
    for (var other = 0u; other < boxes; other++) {
        let count = seeds[other].y;
        let is_first = count > seed.y || (count == seed.y && ranked(other) < ranked(box));
        number += select(0u, 1u, count > 0u && is_first);
    }
    return select(own, ranked(box) - box + number, number < REGIONS);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let index = cell_in(params.count, id);
    if (params.step == 0u) {
        after[index] = begun(id, select(before[index], UNREACHED, params.turn == 0u));
        return;
    }
    // The nearest beginning: its own, or a neighbour's through a face that is open both ways.
    var found = before[index];
    for (var hop = 0u; hop < 6u; hop++) {
        if (!open_both_ways(id, hop)) { continue; }
        let far = before[cell_in(params.count, hop_from(id, hop))];
        if (far != UNREACHED) {
            found = min(found, far + STEP);
        }
    }
    after[index] = found;
}
