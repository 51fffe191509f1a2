// Where shadow maps and the bounds of their squares lie in one buffer; see shafts/bounds.py.
// Level 0 is the map itself, two texels of a row an entry; every level lies where a shift says, so
// that one read serves all of them.
//! use depth_bounds

fn level_entry(side: u32, layer: u32, level: u32, square: vec2u) -> u32 {
    let first = (side * side) >> max(2u * level, 1u);
    let x = select(square.x, square.x >> 1u, level == 0u);
    return layer * side * side + first + square.y * (side >> max(level, 1u)) + x;
}

// The bounds of a square from the entry read for it.
fn level_bounds(entry: vec2f, level: u32, square: vec2u) -> vec2f {
    let texel = shadow_depth(select(entry.x, entry.y, (square.x & 1u) == 1u));
    return select(entry, vec2f(texel), level == 0u);
}
