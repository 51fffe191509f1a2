// Where shadow maps and the bounds of their squares lie in one buffer; see media/shafts/bounds.py.
// Level 0 is the map itself, as float32; a square of the levels above is one word: the nearest depth
// in its low half, the farthest in its high one, in parts of 65535, rounded outwards. A texel that
// nothing covers has depth 1; rays are held before it, so that it shadows nothing.

const DEPTH_PARTS = 65535.0;
const FARTHEST = 0.999999;
const NEAREST_BITS = 0xffffu;
const FARTHEST_BITS = 0xffff0000u;

// Every level lies where a shift says. The row of squares begins at a texel's row `y` of the map.
fn level_entry(first: u32, side: u32, level: u32, texel: vec2u) -> u32 {
    let rows = firstTrailingBit(side);
    let row = ((texel.y >> level << level) << rows) | (side * side);
    return first + (row >> (2u * level)) + (texel.x >> level);
}

// Of depths 0 to 1, four squares at once.
fn packed_bounds(nearest: vec4f, farthest: vec4f) -> vec4u {
    // A hundredth of a part more than rounding, which unpacking may be off by.
    let low = select(vec4u(max(nearest * DEPTH_PARTS - 0.01, vec4f(0.0))), vec4u(NEAREST_BITS),
        nearest >= vec4f(1.0));
    let high = vec4u(min(ceil(farthest * DEPTH_PARTS + 0.01), vec4f(DEPTH_PARTS)));
    return low | (high << vec4u(16u));
}

// The nearest and farthest depth of a square of `level` from its word.
fn level_bounds(word: u32, level: u32) -> vec2f {
    let bounds = vec2f(vec2u(word & NEAREST_BITS, word >> 16u)) * (1.0 / DEPTH_PARTS);
    return select(bounds, vec2f(bitcast<f32>(word)), level == 0u);
}
