// Where the bounds of shadow-map squares lie in their buffer; see media/shafts/bounds.py.

// A texel that nothing covers shadows nothing, however far.
const NEVER = 1e30;

fn shadow_depth(stored: f32) -> f32 {
    return select(stored, NEVER, stored >= 1.0);
}

// Levels of a pyramid over side^2 texels (a power of two), level 1 first; one pyramid per layer.
fn bounds_index(side: u32, layer: u32, level: u32, square: vec2u) -> u32 {
    let below = side >> (level - 1u);
    let first = (side * side - below * below) / 3u;
    return layer * ((side * side - 1u) / 3u) + first + square.y * (side >> level) + square.x;
}
