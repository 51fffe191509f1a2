// Cells of surfaces in a table by a hash, with the light that later segments of paths brought to what first ones met
// there. SLOTS and WORDS are of gather/later.py.
//! use sampling

const TRIES = 16u;
const EMPTY = 0u;
// The words of a cell: its name, how many paths, and a sum in two words for each channel.
const NAME = 0u;
const COUNT = 1u;
const SUMS = 2u;
const LOW = 4294967296.0;   // units of a sum's lower word

// A cell of the scene's surfaces: where, how large, and which way they face.
struct LaterCell {
    slot: u32,
    name: u32,              // by which others in the same slot differ, not EMPTY
    size: f32,              // m
}

// As wide as a share of the distance to the eye, by powers of two.
fn later_cell(p: vec3f, n: vec3f, eye: vec3f, share: f32) -> LaterCell {
    let level = ceil(log2(max(share * distance(p, eye), 1e-12)));
    let size = exp2(level);
    // Surfaces of one cell face the same side of the cube.
    let a = abs(n);
    let axis = select(select(2u, 1u, a.y >= a.z), 0u, a.x >= max(a.y, a.z));
    let side = 2u * axis + u32(n[axis] < 0.0);
    let at = vec3i(floor(p / size));
    var hash = pcg_hash(bitcast<u32>(i32(level)) * 6u + side);
    hash = pcg_hash(hash + bitcast<u32>(at.x));
    hash = pcg_hash(hash + bitcast<u32>(at.y));
    hash = pcg_hash(hash + bitcast<u32>(at.z));
    return LaterCell(hash % SLOTS, max(pcg_hash(hash + 1013904242u), 1u), size);
}
